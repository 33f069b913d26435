// SPDX-License-Identifier: Apache-2.0
#include "runtime/search/lanes/lane_search.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>
#include <mutex>
#include <stdexcept>
#include <thread>

#include "runtime/search/evaluate.h"
#include "runtime/search/lanes/frontier.h"
#include "runtime/search/lanes/lane_bound.h"
#include "runtime/search/lanes/lane_branching.h"
#include "runtime/search/seeds.h"
#include "runtime/search/suppression.h"

namespace sextant {
namespace {

constexpr double kNever = -std::numeric_limits<double>::infinity();
/// Greedy descents before the search: a good incumbent early.
constexpr int kProbes = 8;
/// Nodes between two looks at the clock.
constexpr int kNodesPerLook = 8;

/// The smallest float that is not below the value: bounds stay bounds.
float rounded_up(double value) {
  const auto f = static_cast<float>(value);
  return static_cast<double>(f) < value ? std::nextafter(f, std::numeric_limits<float>::infinity()) : f;
}

/// Tiles of one stage of one object, made when they are first needed.
class TileGrid {
 public:
  void reset(const Constraint& constraint, int stage) {
    constraint_ = &constraint;
    stage_ = stage;
    const int cell = kLaneStages[static_cast<std::size_t>(stage)].cell;
    width_ = kLaneColumns * cell;
    height_ = kLaneRows * cell;
    columns_ = (constraint.camera().width + width_ - 1) / width_;
    rows_ = (constraint.camera().height + height_ - 1) / height_;
    tiles_ = std::vector<std::atomic<LaneTile*>>(static_cast<std::size_t>(columns_) *
                                                 static_cast<std::size_t>(rows_));
  }
  TileGrid() = default;
  TileGrid(TileGrid&&) = default;
  ~TileGrid() { clear(); }
  void clear() {
    for (auto& t : tiles_) delete t.exchange(nullptr);
  }
  int tile_width() const { return width_; }
  int tile_height() const { return height_; }
  std::size_t size() const { return tiles_.size(); }
  int x0(std::size_t i) const { return static_cast<int>(i) % columns_ * width_; }
  int y0(std::size_t i) const { return static_cast<int>(i) / columns_ * height_; }
  const LaneTile& at(int x0, int y0) {
    auto& slot = tiles_[static_cast<std::size_t>(y0 / height_) * static_cast<std::size_t>(columns_) +
                        static_cast<std::size_t>(x0 / width_)];
    LaneTile* tile = slot.load(std::memory_order_acquire);
    if (tile != nullptr) return *tile;
    auto made = std::make_unique<LaneTile>(lane_tile(*constraint_, stage_, x0, y0));
    if (slot.compare_exchange_strong(tile, made.get(), std::memory_order_acq_rel)) return *made.release();
    return *tile;  // another thread was first
  }

 private:
  const Constraint* constraint_ = nullptr;
  int stage_ = 0, width_ = 1, height_ = 1, columns_ = 0, rows_ = 0;
  std::vector<std::atomic<LaneTile*>> tiles_;
};

/// What a search does for one object at the moment.
enum class Phase : std::uint8_t {
  kFind,   ///< looks for the next detection
  kHeld,   ///< its detections are known; other objects' are not yet
  kRival,  ///< looks for the best other explanation of a detection
  kDone,
};

/// One object's state during a search.
struct TargetState {
  const LaneTarget* target = nullptr;
  int first_bin = 0;  ///< among the bins of all objects
  std::array<TileGrid, kLaneStages.size()> grids;
  std::vector<Box2> boxes;         ///< of what suppresses: all detections, or those better than the rival's
  std::vector<PoseBall> balls;     ///< around the detections, while rivals are looked for
  std::vector<ScoredPose> leaves;  ///< poses evaluated so far, where later passes may want them
  SearchOutcome outcome;
  Phase phase = Phase::kFind;
  std::mutex mutex;  ///< guards best and leaves
  ScoredPose best{{}, kNever};
  std::atomic<double> best_score{kNever};
  std::atomic<double> unvisited{
      kNever};  ///< no pose below the roots that time did not suffice for scores higher

  void leave_unvisited(double bound) {
    double now = unvisited.load(std::memory_order_relaxed);
    while (bound > now && !unvisited.compare_exchange_weak(now, bound)) {
    }
  }
  bool last_wanted() const { return static_cast<int>(outcome.found.size()) + 1 >= target->max_detections; }
  /// Rivals of this detection or of later ones do not matter below this.
  double floor_of_rival(std::size_t i) const {
    return rival_floor(outcome.found[i].score, target->threshold, *target->runner_up);
  }
  bool last_rival() const { return outcome.runner_ups.size() + 1 >= outcome.found.size(); }
  /// Nodes below this cannot hold the pose that the pass looks for.
  double wanted() const {
    const double best_now = best_score.load(std::memory_order_relaxed);
    if (phase == Phase::kFind) return std::max(target->threshold, best_now);
    if (phase == Phase::kRival) return std::max(floor_of_rival(outcome.runner_ups.size()), best_now);
    return std::numeric_limits<double>::infinity();
  }
  /// Nodes below this are of no use to later passes either.
  double useful() const {
    if (phase == Phase::kDone) return wanted();
    if (phase == Phase::kFind) {
      if (!last_wanted()) return target->threshold;
      if (!target->runner_up) return wanted();
      return rival_floor(best_score.load(std::memory_order_relaxed), target->threshold, *target->runner_up);
    }
    return phase == Phase::kRival && last_rival() ? wanted() : floor_of_rival(outcome.found.size() - 1);
  }
  /// Whether poses that do not matter in this pass may in a later one.
  bool keeps() const { return target->runner_up ? phase != Phase::kDone : !last_wanted(); }

  void offer(const ScoredPose& pose) {
    const std::lock_guard lock(mutex);
    if (keeps()) leaves.push_back(pose);
    take_if_better(pose);
  }
  void keep(const ScoredPose& pose) {
    const std::lock_guard lock(mutex);
    leaves.push_back(pose);
  }
  void take_if_better(const ScoredPose& pose) {
    if (pose.score < best.score || (pose.score == best.score && !(pose.pose < best.pose))) return;
    best = pose;
    best_score.store(pose.score, std::memory_order_relaxed);
  }
};

struct alignas(64) Worker {
  std::mutex mutex;  ///< guards frontier
  Frontier frontier;
  std::vector<LaneNode> parked;  ///< of no use to this pass
  std::vector<LaneNode> children;
  std::vector<LaneNode> stack;
  LaneCounters counters;
  int until_look = kNodesPerLook;
};

}  // namespace

struct LaneSearch::Impl {
  const LaneSearchProblem* problem = nullptr;
  double focal = 0;
  std::vector<std::unique_ptr<TargetState>> states;
  std::vector<std::uint16_t> target_of_bin;
  std::vector<std::unique_ptr<Worker>> workers;
  std::vector<LaneFrame> frames;  ///< per target
  std::atomic<std::int64_t> outstanding{0};
  std::atomic<bool> stop{false};
  LaneCounters counters;

  TargetState& state_of(const LaneNode& n) { return *states[target_of_bin[static_cast<std::size_t>(n.bin)]]; }
  const LaneFrame& frame_of(const LaneNode& n) {
    return frames[target_of_bin[static_cast<std::size_t>(n.bin)]];
  }
  std::size_t local_bin(const TargetState& s, const LaneNode& n) const {
    return static_cast<std::size_t>(n.bin - s.first_bin);
  }

  bool out_of_time(Worker& w) {
    if (stop.load(std::memory_order_relaxed)) return true;
    if (!problem->expired || --w.until_look > 0) return false;
    w.until_look = kNodesPerLook;
    if (problem->expired()) stop.store(true, std::memory_order_relaxed);
    return stop.load(std::memory_order_relaxed);
  }

  void prepare(const LaneSearchProblem& p, std::size_t threads) {
    problem = &p;
    focal = p.exact.camera().focal;
    stop = false;
    outstanding = 0;
    counters = {};
    states.resize(p.targets.size());
    target_of_bin.clear();
    frames.clear();
    double ceiling = kNever;
    double floor = std::numeric_limits<double>::infinity();
    for (std::size_t t = 0; t < p.targets.size(); ++t) {
      states[t] = std::make_unique<TargetState>();
      TargetState& s = *states[t];
      s.target = &p.targets[t];
      if (!s.target->taken.empty() && s.target->runner_up) {
        throw std::logic_error("a search beside earlier detections proves no runner-up");
      }
      s.boxes = s.target->taken;
      s.first_bin = static_cast<int>(target_of_bin.size());
      target_of_bin.insert(target_of_bin.end(), s.target->bins.size(), static_cast<std::uint16_t>(t));
      for (std::size_t g = 0; g < s.grids.size(); ++g)
        s.grids[g].reset(s.target->constraint, static_cast<int>(g));
      for (const LaneBin& bin : s.target->lane_bins) ceiling = std::max(ceiling, bin.offset);
      floor = std::min(floor, s.target->threshold);
      frames.push_back({p.lanes, p.exact.camera(), s.target->constraint.nearest_index(),
                        s.target->constraint.farthest_index()});
    }
    while (workers.size() < threads) workers.push_back(std::make_unique<Worker>());
    for (auto& w : workers) {
      w->frontier.set_range(floor, ceiling);
      w->parked.clear();
      w->counters = {};
      w->until_look = 1;
    }
  }

  /// Bounds a node; false where no lane can hold a useful pose.
  bool bound(Worker& w, LaneNode& node, float parent_bound) {
    TargetState& s = state_of(node);
    const LaneBin& bin = s.target->lane_bins[local_bin(s, node)];
    if (bin.units_per_score == 0) return false;
    LaneCosts costs;
    lane_bound(frame_of(node), bin, s.grids[node.stage].at(node.x0, node.y0), node,
               budget_units(bin, s.useful()), costs);
    ++(node.stage == 0 ? w.counters.coarse : w.counters.fine);
    w.counters.parts += costs.parts;
    node.alive = costs.alive;
    if (node.alive == 0) return false;
    std::uint16_t least = 65535;
    for (std::uint16_t u : costs.units) least = std::min(least, u);
    node.bound = std::min(parent_bound, rounded_up(score_bound(bin, least)));
    return node.bound >= s.useful();
  }

  void make_roots(WorkerPool& pool, LaneShare share) {
    struct Task {
      TargetState* state;
      std::size_t tile;
      std::vector<LaneNode> nodes;
    };
    std::vector<Task> tasks;
    for (auto& s : states) {
      for (std::size_t i = share.index; i < s->grids[0].size(); i += share.count) {
        tasks.push_back({s.get(), i, {}});
      }
    }
    std::atomic<std::size_t> next{0};
    pool.for_each(static_cast<std::size_t>(pool.threads()), [&](std::size_t me) {
      for (std::size_t i = next++; i < tasks.size(); i = next++) {
        roots_of_tile(*workers[me], *tasks[i].state, tasks[i].tile, tasks[i].nodes);
      }
    });
    std::vector<LaneNode> all;
    for (const Task& t : tasks) all.insert(all.end(), t.nodes.begin(), t.nodes.end());
    std::stable_sort(all.begin(), all.end(),
                     [](const LaneNode& a, const LaneNode& b) { return a.bound < b.bound; });
    for (std::size_t i = 0; i < all.size(); ++i) workers[i % active]->frontier.put(all[i]);
    outstanding.fetch_add(static_cast<std::int64_t>(all.size()));
  }

  void roots_of_tile(Worker& w, TargetState& s, std::size_t index, std::vector<LaneNode>& out) {
    TileGrid& grid = s.grids[0];
    const LaneTile& tile = grid.at(grid.x0(index), grid.y0(index));
    if (tile.feasible == 0) return;
    for (std::size_t b = 0; b < s.target->bins.size(); ++b) {
      const RotationBox& box = s.target->bins[b].box;
      LaneNode node;
      node.bin = s.first_bin + static_cast<int>(b);
      node.x0 = static_cast<std::int16_t>(tile.x0);
      node.y0 = static_cast<std::int16_t>(tile.y0);
      node.offset_lo = static_cast<std::int16_t>(tile.offset_lo);
      node.offset_hi = static_cast<std::int16_t>(tile.offset_hi);
      node.alive = tile.feasible;
      node.lo = {static_cast<std::int16_t>(std::max(first_angle(box.lo_deg[0]), tile.rx_min)),
                 static_cast<std::int16_t>(std::max(first_angle(box.lo_deg[1]), tile.ry_min)),
                 static_cast<std::int16_t>(first_angle(box.lo_deg[2]))};
      node.hi = {static_cast<std::int16_t>(std::min(last_angle(box.hi_deg[0]), tile.rx_max)),
                 static_cast<std::int16_t>(std::min(last_angle(box.hi_deg[1]), tile.ry_max)),
                 static_cast<std::int16_t>(last_angle(box.hi_deg[2]))};
      if (node.lo[0] > node.hi[0] || node.lo[1] > node.hi[1]) continue;
      const float most = rounded_up(s.target->bins[b].offset);
      if (out_of_time(w)) {
        s.leave_unvisited(most);
      } else if (bound(w, node, most)) {
        out.push_back(node);
      }
    }
  }

  /// Lanes for all of whose poses something is true.
  template <typename TrueEverywhere>
  std::uint64_t lanes_where(TargetState& s, const LaneNode& node, TrueEverywhere true_everywhere) {
    const LaneTile& tile = s.grids[node.stage].at(node.x0, node.y0);
    const int cell = kLaneStages[node.stage].cell;
    std::uint64_t out = 0;
    for (std::uint64_t left = node.alive; left != 0; left &= left - 1) {
      const int lane = std::countr_zero(left);
      const auto i = static_cast<std::size_t>(lane);
      Region r;
      r.lo[kX] = static_cast<std::int16_t>(node.x0 + lane % kLaneColumns * cell);
      r.lo[kY] = static_cast<std::int16_t>(node.y0 + lane / kLaneColumns * cell);
      r.hi[kX] = static_cast<std::int16_t>(r.lo[kX] + cell - 1);
      r.hi[kY] = static_cast<std::int16_t>(r.lo[kY] + cell - 1);
      r.lo[kZ] = static_cast<std::int16_t>(std::max(1, tile.anchor_lo[i] + node.offset_lo));
      r.hi[kZ] = static_cast<std::int16_t>(std::max(1, tile.anchor_hi[i] + node.offset_hi));
      for (std::size_t a = 0; a < 3; ++a) {
        r.lo[kRx + a] = node.lo[a];
        r.hi[kRx + a] = node.hi[a];
      }
      if (true_everywhere(r)) out |= std::uint64_t{1} << lane;
    }
    return out;
  }

  /// Lanes all of whose poses are suppressed by what was found.
  std::uint64_t suppressed_lanes(TargetState& s, const LaneNode& node) {
    if (s.boxes.empty()) return 0;
    const ScoredBin& bin = s.target->bins[local_bin(s, node)];
    return lanes_where(s, node, [&](const Region& r) {
      return std::any_of(s.boxes.begin(), s.boxes.end(),
                         [&](const Box2& box) { return suppressed_everywhere(bin, focal, r, box); });
    });
  }

  /// Lanes all of whose poses are too much like a detection to be another explanation.
  std::uint64_t lanes_in_balls(TargetState& s, const LaneNode& node) {
    if (s.balls.empty()) return 0;
    return lanes_where(s, node, [&](const Region& r) {
      return std::any_of(s.balls.begin(), s.balls.end(),
                         [&](const PoseBall& ball) { return ball.contains_all(r); });
    });
  }

  /// Parks the lanes of a single node that only a later pass may want; the others remain.
  LaneNode lanes_wanted_now(Worker& w, TargetState& s, LaneNode node) {
    const double wanted = s.wanted();
    if (!(wanted > s.useful())) return node;
    const LaneBin& bin = s.target->lane_bins[local_bin(s, node)];
    LaneCosts costs;
    lane_bound(frame_of(node), bin, s.grids[node.stage].at(node.x0, node.y0), node,
               budget_units(bin, s.useful()), costs);
    const std::uint16_t budget = budget_units(bin, wanted);
    LaneNode later = node;
    later.alive = 0;
    std::uint16_t least = 65535;
    for (std::uint64_t left = costs.alive; left != 0; left &= left - 1) {
      const auto lane = static_cast<std::size_t>(std::countr_zero(left));
      if (costs.units[lane] <= budget) continue;
      later.alive |= std::uint64_t{1} << lane;
      least = std::min(least, costs.units[lane]);
    }
    if (later.alive != 0) {
      later.bound = std::min(node.bound, rounded_up(score_bound(bin, least)));
      w.parked.push_back(later);
    }
    node.alive = costs.alive & ~later.alive;
    return node;
  }

  bool suppressed(const TargetState& s, const LatticePose& pose) const {
    if (s.boxes.empty()) return false;
    const Box2 box = box_of(s.target->bins[static_cast<std::size_t>(pose.bin)], focal, pose);
    return std::any_of(s.boxes.begin(), s.boxes.end(), [&](const Box2& other) {
      return intersection_over_union(box, other) > kSuppressionIou;
    });
  }
  static bool in_balls(const TargetState& s, const LatticePose& pose) {
    return std::any_of(s.balls.begin(), s.balls.end(),
                       [&](const PoseBall& ball) { return ball.contains(pose); });
  }

  /// A node of the last stage with one distance and rotation per pixel: its poses, exactly.
  void evaluate_lanes(Worker& w, TargetState& s, const LaneNode& node) {
    const LaneTile& tile = s.grids[node.stage].at(node.x0, node.y0);
    const std::size_t b = local_bin(s, node);
    const ScoredBin& bin = s.target->bins[b];
    const Constraint& constraint = s.target->constraint;
    for (std::uint64_t left = node.alive; left != 0; left &= left - 1) {
      const int lane = std::countr_zero(left);
      const int z = tile.anchor_lo[static_cast<std::size_t>(lane)] + node.offset_lo;
      if (z < constraint.nearest_index() || z > constraint.farthest_index()) continue;
      const LatticePose pose{static_cast<std::int32_t>(b),
                             {static_cast<std::int16_t>(node.x0 + lane % kLaneColumns),
                              static_cast<std::int16_t>(node.y0 + lane / kLaneColumns),
                              static_cast<std::int16_t>(z), node.lo[0], node.lo[1], node.lo[2]}};
      if (!constraint.contains(pose)) continue;
      ++w.counters.evaluations;
      const double score = evaluate(bin, problem->exact, pose);
      if (score < s.useful() || in_balls(s, pose)) continue;
      if (!suppressed(s, pose)) {
        s.offer({pose, score});
      } else if (s.phase == Phase::kFind && s.keeps() && s.target->runner_up) {
        s.keep({pose, score});
      }
    }
  }

  /// The children of a node that can still matter, best last; or its poses, where it has none.
  void expand(Worker& w, const LaneNode& node, std::vector<LaneNode>& children) {
    children.clear();
    TargetState& s = state_of(node);
    const bool last_stage = node.stage + std::size_t{1} == kLaneStages.size();
    if (last_stage && node.single()) {
      evaluate_lanes(w, s, lanes_wanted_now(w, s, node));
      return;
    }
    const std::size_t b = local_bin(s, node);
    const LaneTile& tile = s.grids[node.stage].at(node.x0, node.y0);
    const double z =
        std::max(1, tile.row_anchor_lo[1] + (node.offset_lo + node.offset_hi) / 2) * kLatticeDistance;
    const LaneSplit split =
        lane_split(node, s.target->bins[b], s.target->bounding_radius_m, focal, std::clamp(z, 0.1, 100.0));
    if (split != LaneSplit::kStage) {
      auto [first, second] = lane_halves(node, split);
      if (bound(w, first, node.bound)) children.push_back(first);
      if (bound(w, second, node.bound)) children.push_back(second);
    } else {
      expand_cells(w, s, node, children);
    }
    std::sort(children.begin(), children.end(),
              [](const LaneNode& x, const LaneNode& y) { return x.bound < y.bound; });
  }

  void expand_cells(Worker& w, TargetState& s, const LaneNode& node, std::vector<LaneNode>& children) {
    TileGrid& fine = s.grids[node.stage + std::size_t{1}];
    const TileGrid& coarse = s.grids[node.stage];
    const PinholeCamera& camera = s.target->constraint.camera();
    for (int y = node.y0; y < std::min(node.y0 + coarse.tile_height(), camera.height);
         y += fine.tile_height()) {
      for (int x = node.x0; x < std::min(node.x0 + coarse.tile_width(), camera.width);
           x += fine.tile_width()) {
        LaneNode child = node;
        child.alive = lanes_of_child(node, x, y);
        if (child.alive == 0) continue;
        child.stage = static_cast<std::uint8_t>(node.stage + 1);
        child.x0 = static_cast<std::int16_t>(x);
        child.y0 = static_cast<std::int16_t>(y);
        const LaneTile& tile = fine.at(x, y);
        child.alive &= tile.feasible;
        child.offset_lo = std::max(child.offset_lo, static_cast<std::int16_t>(tile.offset_lo));
        child.offset_hi = std::min(child.offset_hi, static_cast<std::int16_t>(tile.offset_hi));
        child.lo[0] = std::max(child.lo[0], static_cast<std::int16_t>(tile.rx_min));
        child.hi[0] = std::min(child.hi[0], static_cast<std::int16_t>(tile.rx_max));
        child.lo[1] = std::max(child.lo[1], static_cast<std::int16_t>(tile.ry_min));
        child.hi[1] = std::min(child.hi[1], static_cast<std::int16_t>(tile.ry_max));
        if (child.alive == 0 || child.offset_lo > child.offset_hi || child.lo[0] > child.hi[0] ||
            child.lo[1] > child.hi[1]) {
          continue;
        }
        if (bound(w, child, node.bound)) children.push_back(child);
      }
    }
  }

  /// Follows the best child down to poses; the other children go to the frontier.
  void probe(Worker& w, LaneNode node) {
    while (true) {
      expand(w, node, w.children);
      if (w.children.empty()) return;
      node = w.children.back();
      w.children.pop_back();
      for (const LaneNode& other : w.children) w.frontier.put(other);
    }
  }

  void probe_best(int count) {
    Worker& w = *workers[0];
    std::vector<LaneNode> best;
    for (int i = 0; i < count; ++i) {
      Worker& from = *workers[static_cast<std::size_t>(i) % active];
      if (!from.frontier.empty()) best.push_back(from.frontier.take());
    }
    // One answer at least, however late it is.
    for (std::size_t i = 0; i < best.size(); ++i) {
      w.until_look = 1;
      if (i > 0 && out_of_time(w)) {
        w.frontier.put(best[i]);
      } else {
        probe(w, best[i]);
      }
    }
  }

  bool steal(std::size_t me) {
    for (std::size_t i = 1; i < active; ++i) {
      Worker& victim = *workers[(me + i) % active];
      std::vector<LaneNode> taken;
      {
        const std::lock_guard lock(victim.mutex);
        for (std::size_t n = std::min<std::size_t>(victim.frontier.size() / 2, 64); n > 0; --n) {
          taken.push_back(victim.frontier.take());
        }
      }
      if (taken.empty()) continue;
      const std::lock_guard lock(workers[me]->mutex);
      for (const LaneNode& node : taken) workers[me]->frontier.put(node);
      return true;
    }
    return false;
  }

  void work(std::size_t me) {
    Worker& w = *workers[me];
    while (outstanding.load(std::memory_order_acquire) > 0) {
      if (out_of_time(w)) return;
      LaneNode node;
      {
        std::unique_lock lock(w.mutex);
        if (w.frontier.empty()) {
          lock.unlock();
          if (active == 1) return;
          if (!steal(me)) std::this_thread::yield();
          continue;
        }
        node = w.frontier.take();
      }
      process(w, node);
      outstanding.fetch_sub(1, std::memory_order_acq_rel);
    }
  }

  void process(Worker& w, const LaneNode& top) {
    w.stack.assign(1, top);
    while (!w.stack.empty()) {
      LaneNode node = w.stack.back();
      w.stack.pop_back();
      TargetState& s = state_of(node);
      if (node.bound < s.wanted()) {
        if (node.bound >= s.useful()) w.parked.push_back(node);
        continue;
      }
      node.alive &= ~lanes_in_balls(s, node);
      const std::uint64_t hidden = suppressed_lanes(s, node);
      if (hidden != 0 && s.phase == Phase::kFind && s.target->runner_up) {
        w.parked.push_back(node);  // may hold another explanation of what hides it
        w.parked.back().alive = hidden;
      }
      node.alive &= ~hidden;
      if (node.alive == 0) continue;
      expand(w, node, w.children);
      const auto waiting = static_cast<std::uint64_t>(outstanding.load(std::memory_order_relaxed));
      w.counters.most_waiting = std::max(w.counters.most_waiting, waiting);
      if (waiting > problem->most_waiting_nodes && !stop.load(std::memory_order_relaxed)) {
        w.stack.insert(w.stack.end(), w.children.begin(), w.children.end());
        if (!out_of_time(w)) continue;
        w.children.swap(w.stack);
        w.stack.clear();
      }
      put(w, w.children);
      if (!w.stack.empty() && stop.load(std::memory_order_relaxed)) {
        put(w, w.stack);
        w.stack.clear();
      }
    }
  }

  void put(Worker& w, const std::vector<LaneNode>& nodes) {
    if (nodes.empty()) return;
    outstanding.fetch_add(static_cast<std::int64_t>(nodes.size()), std::memory_order_acq_rel);
    const std::lock_guard lock(w.mutex);
    for (const LaneNode& node : nodes) w.frontier.put(node);
  }

  /// Searches until every object's best remaining pose is known. False: out of time.
  bool pass(WorkerPool& pool) {
    unpark();
    pool.for_each(active, [&](std::size_t me) { work(me); });
    return !stop.load();
  }

  /// The best of the poses evaluated so far that count.
  void best_of_leaves(TargetState& s) {
    s.best = {{}, kNever};
    s.best_score = kNever;
    for (const ScoredPose& leaf : s.leaves) {
      if (!suppressed(s, leaf.pose)) s.take_if_better(leaf);
    }
  }

  /// The best pose of an object becomes a detection; the leaves that it suppresses go, unless they may be
  /// another explanation of it.
  void take_best(TargetState& s) {
    const LaneTarget& t = *s.target;
    s.outcome.found.push_back(s.best);
    s.boxes.push_back(box_of(t.bins[static_cast<std::size_t>(s.best.pose.bin)], focal, s.best.pose));
    if (!t.runner_up) {
      std::erase_if(s.leaves, [&](const ScoredPose& leaf) { return suppressed(s, leaf.pose); });
    }
    if (static_cast<int>(s.outcome.found.size()) >= t.max_detections) {
      s.phase = t.runner_up ? Phase::kHeld : Phase::kDone;
    } else {
      best_of_leaves(s);
    }
  }

  /// From detections to their rivals: what lies in the balls does not count from here on.
  void start_rivals(TargetState& s) {
    if (s.phase != Phase::kHeld) return;
    for (const ScoredPose& f : s.outcome.found) {
      s.balls.emplace_back(s.target->constraint.camera(), f.pose, s.target->runner_up->ball);
    }
    s.boxes.clear();
    std::erase_if(s.leaves, [&](const ScoredPose& leaf) { return in_balls(s, leaf.pose); });
    best_of_leaves(s);
    s.phase = Phase::kRival;
  }

  /// The pass has proven the best rival of one detection; on to the next detection's.
  void take_rival(TargetState& s, double bound_of_rest) {
    const std::size_t i = s.outcome.runner_ups.size();
    const double floor = s.floor_of_rival(i);
    const bool exact = s.best.score >= std::max(floor, bound_of_rest);
    s.outcome.runner_ups.push_back({std::max({floor, bound_of_rest, s.best.score}), exact});
    const ScoredPose& f = s.outcome.found[i];
    s.boxes.push_back(box_of(s.target->bins[static_cast<std::size_t>(f.pose.bin)], focal, f.pose));
    best_of_leaves(s);
    if (i + 1 == s.outcome.found.size()) s.phase = Phase::kDone;
  }

  template <typename Visit>
  void for_each_waiting(Visit visit) {
    for (const auto& w : workers) {
      w->frontier.for_each(visit);
      for (const LaneNode& node : w->parked) visit(node);
    }
  }

  /// Out of time: the highest bound of what is left for each object.
  double highest_waiting(TargetState& s) {
    double highest = s.unvisited.load();
    for_each_waiting([&](const LaneNode& node) {
      if (&state_of(node) != &s || node.bound <= highest) return;
      if ((node.alive & ~suppressed_lanes(s, node) & ~lanes_in_balls(s, node)) == 0) return;
      highest = static_cast<double>(node.bound);
    });
    return highest;
  }

  /// elsewhere: per object, the highest that waits in other processes.
  void finish(bool complete, const std::vector<double>& elsewhere) {
    const auto highest = [&](TargetState& s, std::size_t i) {
      return std::max(highest_waiting(s), elsewhere.empty() ? kNever : elsewhere[i]);
    };
    for (std::size_t i = 0; i < states.size(); ++i) {
      auto& s = states[i];
      SearchOutcome& o = s->outcome;
      const LaneTarget& t = *s->target;
      o.complete = complete || s->phase != Phase::kFind;
      // Only proven detections hide what waits: a better pose in the place of an unproven one still counts.
      const double rest = o.complete ? kNever : highest(*s, i);
      while (s->phase == Phase::kFind && s->best.score > kNever) take_best(*s);
      const bool full = static_cast<int>(o.found.size()) >= t.max_detections;
      o.upper_bound = full ? std::max(t.threshold, o.found.back().score) : t.threshold;
      if (!o.complete) {
        o.upper_bound = std::max(o.upper_bound, rest);
        continue;
      }
      start_rivals(*s);
      while (s->phase == Phase::kRival) take_rival(*s, highest(*s, i));
    }
  }

  std::size_t active = 1;
  std::uint64_t answered = 0;  ///< nodes bounded until all detections were known

  void plant_seeds() {
    for (auto& s : states) {
      const LaneTarget& t = *s->target;
      const SearchProblem space{t.bins, problem->exact, t.constraint, t.bounding_radius_m};
      for (const LatticePose& seed : t.seeds) {
        const auto score = score_of(space, seed);
        if (score && *score >= t.threshold && !suppressed(*s, seed)) s->offer({seed, *score});
      }
    }
  }

  /// What was parked waits again.
  void unpark() {
    std::int64_t waiting = 0;
    for (std::size_t i = 0; i < active; ++i) {
      Worker& w = *workers[i];
      for (const LaneNode& node : w.parked) w.frontier.put(node);
      w.parked.clear();
      waiting += static_cast<std::int64_t>(w.frontier.size());
    }
    outstanding = waiting;
  }

  std::uint64_t bounded() const {
    std::uint64_t nodes = 0;
    for (const auto& w : workers) nodes += w->counters.coarse + w->counters.fine;
    return nodes;
  }

  bool any_in(Phase phase) const {
    return std::any_of(states.begin(), states.end(), [&](const auto& s) { return s->phase == phase; });
  }

  /// Nothing waits: the best pose of every object is what this pass looked for. False: all is proven.
  bool end_pass() {
    if (any_in(Phase::kFind)) {
      for (auto& s : states) {
        if (s->phase != Phase::kFind) continue;
        if (s->best.score > kNever) {
          take_best(*s);
        } else {  // nothing is left above the threshold
          s->phase = s->outcome.found.empty() || !s->target->runner_up ? Phase::kDone : Phase::kHeld;
        }
      }
      if (any_in(Phase::kFind)) return true;
      answered = bounded();
      for (auto& s : states) start_rivals(*s);
    } else {
      for (auto& s : states) {
        if (s->phase == Phase::kRival) take_rival(*s, kNever);
      }
    }
    return any_in(Phase::kRival);
  }

  std::vector<SearchOutcome> outcomes() {
    std::vector<SearchOutcome> out;
    for (auto& w : workers) {
      counters.coarse += w->counters.coarse;
      counters.fine += w->counters.fine;
      counters.parts += w->counters.parts;
      counters.evaluations += w->counters.evaluations;
      counters.most_waiting = std::max(counters.most_waiting, w->counters.most_waiting);
    }
    counters.rival = answered > 0 ? counters.coarse + counters.fine - answered : 0;
    for (auto& s : states) out.push_back(std::move(s->outcome));
    if (!out.empty()) out[0].nodes = counters.coarse + counters.fine;
    states.clear();
    return out;
  }

  void begin(const LaneSearchProblem& p, WorkerPool& pool, LaneShare share) {
    active = static_cast<std::size_t>(pool.threads());
    answered = 0;
    prepare(p, active);
    plant_seeds();
    make_roots(pool, share);
    for (auto& w : workers) counters.roots += w->counters.coarse;
    probe_best(kProbes);
  }

  std::vector<SearchOutcome> run(const LaneSearchProblem& p, WorkerPool& pool) {
    begin(p, pool, {});
    bool in_time = !stop.load();
    bool more = any_in(Phase::kFind);
    while (in_time && more) {
      in_time = pass(pool);
      if (in_time) more = end_pass();
    }
    finish(in_time, {});
    return outcomes();
  }
};

LaneSearch::LaneSearch() : impl_(std::make_unique<Impl>()) {}
LaneSearch::~LaneSearch() = default;
std::vector<SearchOutcome> LaneSearch::run(const LaneSearchProblem& problem, WorkerPool& pool) {
  return impl_->run(problem, pool);
}
const LaneCounters& LaneSearch::counters() const { return impl_->counters; }

void LaneSearch::begin(const LaneSearchProblem& problem, LaneShare share) {
  WorkerPool serial(1);
  impl_->begin(problem, serial, share);
  impl_->unpark();
}

void LaneSearch::add_roots(LaneShare share) {
  WorkerPool serial(1);
  impl_->make_roots(serial, share);
}

void LaneSearch::step(std::size_t nodes) {
  Worker& w = *impl_->workers[0];
  for (; nodes > 0 && !w.frontier.empty(); --nodes) {
    const LaneNode node = w.frontier.take();
    impl_->process(w, node);
    impl_->outstanding.fetch_sub(1);
  }
}

std::size_t LaneSearch::waiting() const { return impl_->workers[0]->frontier.size(); }

std::size_t LaneSearch::kept() const {
  std::size_t kept = impl_->workers[0]->parked.size();
  for (const auto& s : impl_->states) kept += s->leaves.size();
  return kept;
}

std::vector<LaneNode> LaneSearch::give(std::size_t most) {
  Frontier& frontier = impl_->workers[0]->frontier;
  std::vector<LaneNode> nodes;
  while (nodes.size() < most && !frontier.empty()) nodes.push_back(frontier.take());
  impl_->outstanding.fetch_sub(static_cast<std::int64_t>(nodes.size()));
  return nodes;
}

void LaneSearch::take(const std::vector<LaneNode>& nodes) { impl_->put(*impl_->workers[0], nodes); }

std::vector<ScoredPose> LaneSearch::bests() const {
  std::vector<ScoredPose> out;
  for (const auto& s : impl_->states) out.push_back(s->best);
  return out;
}

void LaneSearch::offer(std::size_t target, const ScoredPose& pose) {
  impl_->states[target]->take_if_better(pose);
}

bool LaneSearch::advance(const std::vector<ScoredPose>& bests) {
  for (std::size_t i = 0; i < bests.size(); ++i) impl_->states[i]->take_if_better(bests[i]);
  const bool more = impl_->end_pass();
  impl_->unpark();
  return more;
}

std::vector<double> LaneSearch::highest_waiting() {
  std::vector<double> out;
  for (auto& s : impl_->states) out.push_back(impl_->highest_waiting(*s));
  return out;
}

std::vector<double> LaneSearch::highest_possible() const {
  std::vector<double> out;
  for (const auto& s : impl_->states) {
    double highest = kNever;
    for (const ScoredBin& bin : s->target->bins) highest = std::max(highest, bin.offset);
    out.push_back(highest);
  }
  return out;
}

std::vector<SearchOutcome> LaneSearch::finish(bool complete, const std::vector<double>& elsewhere) {
  impl_->finish(complete, elsewhere);
  return impl_->outcomes();
}

}  // namespace sextant
