// SPDX-License-Identifier: Apache-2.0
#include "runtime/search/branch_and_bound.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <queue>

#include "runtime/search/bound.h"
#include "runtime/search/branching.h"
#include "runtime/search/evaluate.h"
#include "runtime/search/suppression.h"

namespace sextant {
namespace {

// Regions taken from the frontier at once. Their children are bounded in parallel; the size is fixed so that
// the same regions are visited for any number of threads.
constexpr std::size_t kBatch = 64;
// Greedy descents before the search starts, and when it runs out of time: they give an answer early.
constexpr int kDives = 4;
constexpr double kNever = -std::numeric_limits<double>::infinity();

/// A region with what it can still hold. `exact`: a single pose with its score.
struct Node {
  double bound = 0;
  bool exact = false;
  Region region;
};

/// Order of the frontier: highest bound first; of equals, regions before poses (they may hold a pose of the
/// same score that comes first in the total order), then the total order.
struct Later {
  bool operator()(const Node& a, const Node& b) const {
    if (a.bound != b.bound) return a.bound < b.bound;
    if (a.exact != b.exact) return a.exact;
    return b.region.first() < a.region.first();
  }
};

class Search {
 public:
  Search(const SearchProblem& problem, const SearchOptions& options, WorkerPool& pool)
      : problem_(problem), options_(options), pool_(pool), focal_(problem.tables.camera().focal) {}

  SearchOutcome run() {
    add_roots();
    while (!frontier_.empty() && !full()) {
      if (frontier_.top().exact) {
        take_pose();
        continue;
      }
      if (options_.expired && options_.expired()) {
        dive_for_answers();
        return finish(false);
      }
      expand_batch();
    }
    return finish(true);
  }

 private:
  bool full() const { return static_cast<int>(outcome_.found.size()) >= options_.max_detections; }
  const ScoredBin& bin_of(const Region& r) const { return problem_.bins[static_cast<std::size_t>(r.bin)]; }

  void add_roots() {
    std::vector<Region> roots;
    for (std::size_t i = 0; i < problem_.bins.size(); ++i) {
      roots.push_back(problem_.constraint.whole(static_cast<int>(i), problem_.bins[i].box));
    }
    add(roots, std::vector<double>(roots.size(), std::numeric_limits<double>::infinity()));
  }

  /// Bounds regions in parallel and puts those that can still matter on the frontier.
  void add(const std::vector<Region>& regions, const std::vector<double>& parent_bounds) {
    std::vector<Node> nodes(regions.size());
    pool_.for_each(regions.size(), [&](std::size_t i) { nodes[i] = bounded(regions[i], parent_bounds[i]); });
    for (const Node& node : nodes) {
      if (node.bound >= options_.threshold) frontier_.push(node);
    }
    outcome_.nodes += regions.size();
  }

  Node bounded(const Region& region, double parent_bound) const {
    Node node{kNever, false, problem_.constraint.tightened(region)};
    if (node.region.empty() || suppressed(node.region)) return node;
    if (node.region.single()) {
      if (!problem_.constraint.contains(node.region.first())) return node;
      if (options_.excluded.contains(bin_of(region), focal_, node.region.first())) return node;
      node.exact = true;
      node.bound = evaluate(bin_of(region), problem_.tables, node.region.first());
      return node;
    }
    node.bound = std::min(parent_bound,
                          window_bound(bin_of(region), problem_.tables, node.region, options_.threshold));
    return node;
  }

  /// By what is proven: a better pose in the place of an unproven one still counts.
  bool suppressed(const Region& region) const {
    return std::any_of(
               boxes_.begin(), boxes_.begin() + static_cast<std::ptrdiff_t>(proven_.value_or(boxes_.size())),
               [&](const Box2& box) { return suppressed_everywhere(bin_of(region), focal_, region, box); }) ||
           options_.excluded.contains_all(bin_of(region), focal_, region);
  }

  void expand_batch() {
    std::vector<Region> children;
    std::vector<double> bounds;
    while (children.size() < 2 * kBatch && !frontier_.empty() && !frontier_.top().exact) {
      const Node node = frontier_.top();
      frontier_.pop();
      if (!boxes_.empty() && suppressed(node.region)) continue;
      const auto [a, b] = halves(bin_of(node.region), problem_.bounding_radius_m, focal_, node.region);
      children.insert(children.end(), {a, b});
      bounds.insert(bounds.end(), 2, node.bound);
    }
    add(children, bounds);
  }

  /// The best pose left becomes a detection unless a better one suppresses it.
  void take_pose() {
    const Node node = frontier_.top();
    frontier_.pop();
    const Box2 box = box_of(bin_of(node.region), focal_, node.region.first());
    const bool hidden = std::any_of(boxes_.begin(), boxes_.end(), [&](const Box2& other) {
      return intersection_over_union(box, other) > kSuppressionIou;
    });
    if (hidden) return;
    outcome_.found.push_back({node.region.first(), node.bound});
    boxes_.push_back(box);
  }

  /// Follows the better half of a region down to a single pose; the other halves go to the frontier.
  void dive(Node node) {
    while (!node.exact) {
      const auto [a, b] = halves(bin_of(node.region), problem_.bounding_radius_m, focal_, node.region);
      Node first = bounded(a, node.bound);
      Node second = bounded(b, node.bound);
      outcome_.nodes += 2;
      if (Later{}(first, second)) std::swap(first, second);
      if (second.bound >= options_.threshold) frontier_.push(second);
      if (first.bound < options_.threshold) return;
      node = first;
    }
    frontier_.push(node);
  }

  /// Out of time: turns the best regions into poses and reports those that the order allows.
  void dive_for_answers() {
    proven_ = boxes_.size();
    for (int i = 0; i < kDives && !frontier_.empty() && !frontier_.top().exact; ++i) {
      const Node node = frontier_.top();
      frontier_.pop();
      dive(node);
    }
    std::vector<Node> poses;
    std::vector<Node> regions;
    for (; !frontier_.empty(); frontier_.pop())
      (frontier_.top().exact ? poses : regions).push_back(frontier_.top());
    for (const Node& node : poses) {
      frontier_.push(node);
      if (!full()) take_pose();
    }
    for (const Node& node : regions) frontier_.push(node);
  }

  /// The certificate: the highest bound left on the frontier that no detection suppresses.
  SearchOutcome finish(bool complete) {
    outcome_.complete = complete;
    while (!frontier_.empty() && suppressed(frontier_.top().region)) frontier_.pop();
    outcome_.upper_bound = frontier_.empty() ? kNever : frontier_.top().bound;
    // What was never put on the frontier scores below the threshold.
    outcome_.upper_bound = std::max(outcome_.upper_bound, options_.threshold);
    return std::move(outcome_);
  }

  const SearchProblem& problem_;
  const SearchOptions& options_;
  WorkerPool& pool_;
  double focal_;
  std::priority_queue<Node, std::vector<Node>, Later> frontier_;
  std::vector<Box2> boxes_;            ///< of the detections
  std::optional<std::size_t> proven_;  ///< how many of them are proven; none: all
  SearchOutcome outcome_;
};

}  // namespace

SearchOutcome branch_and_bound(const SearchProblem& problem, const SearchOptions& options, WorkerPool& pool) {
  return Search(problem, options, pool).run();
}

}  // namespace sextant
