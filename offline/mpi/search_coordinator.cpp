// SPDX-License-Identifier: Apache-2.0
#include "offline/mpi/search_coordinator.h"

#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <limits>
#include <thread>

#include "offline/mpi/detect_wire.h"
#include "offline/mpi/frame_wire.h"
#include "runtime/base/error.h"
#include "runtime/model/model_file.h"

namespace sextant {
namespace {

constexpr double kNever = -std::numeric_limits<double>::infinity();
constexpr std::size_t kNodesPerLook = 32;
/// A queue shorter than this is not worth a message.
constexpr std::uint64_t kLeastToShare = 16;
constexpr std::uint64_t kMostToMove = 4096;
constexpr double kLongestHello = 60;     ///< seconds
constexpr double kLongestGoodbye = 0.5;  ///< seconds that ranks have to say what waits, out of time
constexpr double kLookInterval = 0.05;   ///< seconds between two looks for dead ranks

void rest() { std::this_thread::sleep_for(std::chrono::microseconds(100)); }

}  // namespace

SearchCoordinator::SearchCoordinator(int ranks, const CoordinatorOptions& options) : options_(options) {
  std::array<char, 64> host{};
  gethostname(host.data(), host.size() - 1);
  host_ = host.data();
  for (int rank = 1; rank < ranks; ++rank) workers_.emplace_back().rank = rank;
  const double start = MPI_Wtime();
  const auto silent = [&] {
    return std::find_if(workers_.begin(), workers_.end(), [](const Worker& w) { return !w.spoke; });
  };
  while (silent() != workers_.end()) {
    if (!handle_messages()) rest();
    if (MPI_Wtime() - start > kLongestHello) {
      throw DeviceError(fmt::format("rank {}", silent()->rank), "does not speak", "see whether it started");
    }
  }
}

std::size_t SearchCoordinator::lost() const {
  return static_cast<std::size_t>(
      std::count_if(workers_.begin(), workers_.end(), [](const Worker& w) { return w.lost; }));
}

bool SearchCoordinator::lost_elsewhere() const {
  return std::any_of(workers_.begin(), workers_.end(), [](const Worker& w) { return w.lost && !w.here; });
}

void SearchCoordinator::send_setup(const Detector& detector) {
  Bytes setup;
  append(setup, SetupMessage{detector.models().size()});
  append_options(setup, detector.options());
  close_frame();
  for (const Worker& w : workers_) {
    if (!w.lost) mail_.send(w.rank, SearchTag::kSetup, setup);
  }
  for (const ObjectModel& model : detector.models()) {
    const Bytes file = encode_model(model);
    for (const Worker& w : workers_) {
      if (!w.lost) mail_.send(w.rank, SearchTag::kModel, file);
    }
  }
}

void SearchCoordinator::close_frame() {
  if (!frame_open_) return;
  frame_open_ = false;
  for (const Worker& w : workers_) {
    if (!w.lost) mail_.send_plain(w.rank, SearchTag::kStop, stamp_);
  }
}

void SearchCoordinator::keep_alive() {
  // With a frame open its share of the roots is dealt already: who died is found by run().
  if (!frame_open_) look_for_lost(true);
  for (const Worker& w : workers_) {
    if (!w.lost) mail_.send(w.rank, SearchTag::kAlive, {});
  }
}

void SearchCoordinator::send_frame(const RgbdFrame& frame, const DetectCall& call,
                                   const std::vector<ObjectModel>& models) {
  look_for_lost(true);
  close_frame();
  frame_open_ = true;
  ++stamp_.frame;
  stamp_.pass = 0;
  const auto count = static_cast<std::uint32_t>(1 + workers_.size() - lost());
  std::uint32_t index = 0;
  for (Worker& w : workers_) {
    if (w.lost) continue;
    w.share = {++index, count};
    w.status = {};
    w.fresh = false;
    w.sent_nodes = 0;
    w.wanted_by = kNobody;
    w.responsible.clear();
    // A worker prepares the frame before it speaks again.
    w.last_heard = MPI_Wtime();
    Bytes bytes;
    append(bytes, FrameShare{stamp_.frame, index, count});
    append_call(bytes, call, models);
    append_frame(bytes, frame);
    mail_.send(w.rank, SearchTag::kFrame, std::move(bytes));
  }
}

std::vector<SearchOutcome> SearchCoordinator::run(const LaneSearchProblem& problem) {
  const std::size_t targets = problem.targets.size();
  frame_open_ = false;  // ended by stop()
  my_nodes_ = 0;
  nodes_elsewhere_ = 0;
  moved_ = 0;
  pool_.clear();
  search_start_ = MPI_Wtime();
  const auto count = 1 + workers_.size() - lost();
  engine_.begin(problem, {0, count});
  told_.assign(targets, {{}, kNever});
  while (true) {
    const bool heard = handle_messages();
    look_for_lost();
    if (problem.expired && problem.expired()) return stop(false, targets);
    const bool worked = engine_.waiting() > 0;
    engine_.step(kNodesPerLook);
    my_nodes_ += worked ? kNodesPerLook : 0;
    broadcast_bests();
    delegate();
    if (engine_.waiting() == 0 && pool_.empty() && all_idle()) {
      if (!end_pass()) return stop(true, targets);
    } else if (!worked && !heard) {
      rest();
    }
  }
}

bool SearchCoordinator::handle_messages() {
  bool any = false;
  while (auto m = mail_.receive()) {
    any = true;
    handle(*m);
  }
  return any;
}

void SearchCoordinator::handle(const ReceivedMessage& m) {
  Worker& w = workers_.at(static_cast<std::size_t>(m.from - 1));
  if (w.lost) return;  // what it was given is searched again
  w.last_heard = MPI_Wtime();
  ByteReader reader(m.bytes);
  switch (m.tag) {
    case SearchTag::kHello: {
      const auto hello = reader.take<HelloMessage>();
      w.process = hello.process;
      w.here = host_ == hello.host.data();
      w.spoke = true;
      return;
    }
    case SearchTag::kStatus: {
      const auto status = reader.take<StatusMessage>();
      if (status.stamp.frame != stamp_.frame || status.stamp.pass != stamp_.pass) return;
      w.status = status;
      w.fresh = true;
      // Nothing of what it was given is left: acknowledged.
      if (w.idle() && status.kept == 0) {
        w.responsible.clear();
        w.share.count = 0;
      }
      return;
    }
    case SearchTag::kBest: {
      const auto best = reader.take<BestMessage>();
      if (best.stamp.frame == stamp_.frame && best.stamp.pass == stamp_.pass) {
        engine_.offer(best.target, best.pose);
      }
      return;
    }
    case SearchTag::kNodes: {
      const auto stamp = reader.take<SearchStamp>();
      if (stamp.frame != stamp_.frame) return;
      std::vector<LaneNode> nodes = reader.rest<LaneNode>();
      const int to = w.wanted_by;
      w.wanted_by = kNobody;
      w.fresh = false;  // its queue is shorter now
      moved_ += nodes.size();
      if (options_.verbose) {
        fmt::print(stderr, "sextant-mpi: {} nodes from rank {} to rank {}\n", nodes.size(), w.rank,
                   to >= 0 ? workers_[static_cast<std::size_t>(to)].rank : 0);
      }
      if (to >= 0 && !workers_[static_cast<std::size_t>(to)].lost) {
        move_to(workers_[static_cast<std::size_t>(to)], std::move(nodes));
      } else {
        pool_.insert(pool_.end(), nodes.begin(), nodes.end());
      }
      return;
    }
    case SearchTag::kBounds: {
      if (reader.take<SearchStamp>().frame != stamp_.frame || bounds_.empty()) return;
      const std::vector<double> highest = reader.rest<double>();
      for (std::size_t i = 0; i < highest.size(); ++i) bounds_[i] = std::max(bounds_[i], highest[i]);
      w.share.count = 0;  // answered: nothing of it is unknown
      w.responsible.clear();
      ++answers_;
      return;
    }
    default:
      throw std::logic_error("the coordinator got a message for somebody else");
  }
}

void SearchCoordinator::look_for_lost(bool waiting) {
  const double now = MPI_Wtime();
  if (now - last_look_ < kLookInterval) return;
  last_look_ = now;
  for (Worker& w : workers_) {
    if (w.lost) continue;
    if (w.here && kill(static_cast<pid_t>(w.process), 0) != 0 && errno == ESRCH) {
      lose(w, "died");
    } else if (!waiting && now - w.last_heard > options_.lost_after_s) {
      // It must not come back with an old mind, and the job must be able to end.
      if (w.here) kill(static_cast<pid_t>(w.process), SIGKILL);
      lose(w, "is silent");
    }
  }
}

void SearchCoordinator::lose(Worker& w, const char* why) {
  w.lost = true;
  w.wanted_by = kNobody;
  fmt::print(stderr, "sextant-mpi: rank {} {}: its {} boxes are searched again\n", w.rank, why,
             w.responsible.size());
  if (told_.empty()) return;  // between two frames it had nothing
  pool_.insert(pool_.end(), w.responsible.begin(), w.responsible.end());
  w.responsible.clear();
  if (w.share.count > 0) engine_.add_roots(w.share);
}

void SearchCoordinator::broadcast_bests() {
  const std::vector<ScoredPose> bests = engine_.bests();
  for (std::size_t t = 0; t < bests.size(); ++t) {
    if (bests[t].score == kNever) continue;
    if (bests[t].score == told_[t].score && bests[t].pose == told_[t].pose) continue;
    told_[t] = bests[t];
    for (const Worker& w : workers_) {
      if (!w.lost) mail_.send_plain(w.rank, SearchTag::kBest, BestMessage{stamp_, t, bests[t]});
    }
  }
}

void SearchCoordinator::move_to(Worker& w, std::vector<LaneNode> nodes) {
  if (nodes.empty()) return;
  Bytes bytes;
  append(bytes, stamp_);
  for (const LaneNode& node : nodes) append(bytes, node);
  mail_.send(w.rank, SearchTag::kTake, std::move(bytes));
  ++w.sent_nodes;
  w.responsible.insert(w.responsible.end(), nodes.begin(), nodes.end());
}

void SearchCoordinator::delegate() {
  // What was taken back goes to whoever has nothing to do, in pieces.
  if (!pool_.empty() && engine_.waiting() == 0) {
    const std::size_t piece = std::min<std::size_t>(pool_.size(), 64);
    engine_.take({pool_.end() - static_cast<std::ptrdiff_t>(piece), pool_.end()});
    pool_.resize(pool_.size() - piece);
  }
  for (std::size_t i = 0; i < workers_.size(); ++i) {
    Worker& w = workers_[i];
    if (w.lost || !w.idle()) continue;
    if (!pool_.empty()) {
      const std::size_t piece = std::min<std::size_t>(pool_.size(), 64);
      move_to(w, {pool_.end() - static_cast<std::ptrdiff_t>(piece), pool_.end()});
      pool_.resize(pool_.size() - piece);
    } else {
      feed(static_cast<int>(i));
    }
  }
  if (engine_.waiting() == 0 && pool_.empty()) feed(kMyself);
}

/// Asks the rank with the longest queue for its top, in proportion to the two rates.
void SearchCoordinator::feed(int idle) {
  const auto asked_for = [&](const Worker& w) { return w.wanted_by == idle; };
  if (std::any_of(workers_.begin(), workers_.end(), asked_for)) return;
  const double elapsed = std::max(MPI_Wtime() - search_start_, 1e-6);
  const double my_rate = static_cast<double>(my_nodes_) / elapsed;
  const double rate = idle == kMyself ? my_rate : workers_[static_cast<std::size_t>(idle)].status.nodes_per_s;
  const auto share = [&](std::uint64_t waiting, double donor_rate) {
    const double part = rate + donor_rate > 0 ? rate / (rate + donor_rate) : 0.5;
    const auto count = static_cast<std::uint64_t>(std::clamp(part, 0.1, 0.9) * static_cast<double>(waiting));
    return std::min(count, kMostToMove);
  };
  Worker* richest = nullptr;
  for (Worker& w : workers_) {
    if (w.lost || !w.fresh || w.wanted_by != kNobody || w.status.waiting < kLeastToShare) continue;
    if (richest == nullptr || w.status.waiting > richest->status.waiting) richest = &w;
  }
  if (idle != kMyself && engine_.waiting() >= kLeastToShare &&
      (richest == nullptr || engine_.waiting() >= richest->status.waiting)) {
    std::vector<LaneNode> nodes = engine_.give(share(engine_.waiting(), my_rate));
    moved_ += nodes.size();
    move_to(workers_[static_cast<std::size_t>(idle)], std::move(nodes));
    return;
  }
  if (richest == nullptr) return;
  richest->wanted_by = idle;
  mail_.send_plain(richest->rank, SearchTag::kGive,
                   GiveMessage{stamp_, share(richest->status.waiting, richest->status.nodes_per_s)});
}

bool SearchCoordinator::all_idle() const {
  return std::all_of(workers_.begin(), workers_.end(),
                     [](const Worker& w) { return w.lost || (w.idle() && w.wanted_by == kNobody); });
}

bool SearchCoordinator::end_pass() {
  const std::vector<ScoredPose> bests = engine_.bests();
  ++stamp_.pass;
  Bytes bytes;
  append(bytes, stamp_);
  for (const ScoredPose& best : bests) append(bytes, best);
  for (Worker& w : workers_) {
    if (w.lost) continue;
    mail_.send(w.rank, SearchTag::kAdvance, bytes);
    w.fresh = false;
  }
  for (ScoredPose& told : told_) told.score = kNever;
  return engine_.advance(bests);
}

std::vector<SearchOutcome> SearchCoordinator::stop(bool complete, std::size_t targets) {
  bounds_.assign(targets, kNever);
  answers_ = 0;
  for (const Worker& w : workers_) {
    if (!w.lost) mail_.send_plain(w.rank, SearchTag::kStop, stamp_);
  }
  const double start = MPI_Wtime();
  const auto alive = [&] { return workers_.size() - lost(); };
  while (!complete && answers_ < alive() && MPI_Wtime() - start < kLongestGoodbye) {
    if (!handle_messages()) rest();
    look_for_lost();
  }
  if (!complete) {
    for (const LaneNode& node : pool_) engine_.take({node});
    // What a rank that did not answer may still hold: its nodes, and anything where it had roots.
    const std::vector<double> possible = engine_.highest_possible();
    for (const Worker& w : workers_) {
      if (w.lost) continue;
      engine_.take(w.responsible);
      if (w.share.count == 0) continue;
      for (std::size_t i = 0; i < targets; ++i) bounds_[i] = std::max(bounds_[i], possible[i]);
    }
  }
  for (const Worker& w : workers_) nodes_elsewhere_ += w.status.nodes;
  std::vector<SearchOutcome> out = engine_.finish(complete, bounds_);
  if (!out.empty()) out[0].nodes += nodes_elsewhere_;
  bounds_.clear();
  told_.clear();
  pool_.clear();
  return out;
}

void SearchCoordinator::end() {
  for (const Worker& w : workers_) {
    if (!w.lost) mail_.send_plain(w.rank, SearchTag::kEnd, EndMessage{lost() == 0});
  }
}

}  // namespace sextant
