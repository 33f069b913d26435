// SPDX-License-Identifier: Apache-2.0
// The search engine: best-first branch and bound over lane nodes, several objects at once, on one or more
// threads. Its plain twin is branch_and_bound.h: the same poses, scores and certificates, bit for bit,
// whenever it completes.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "runtime/base/worker_pool.h"
#include "runtime/search/branch_and_bound.h"
#include "runtime/search/constraint.h"
#include "runtime/search/lanes/lane_bin.h"
#include "runtime/search/lanes/lane_node.h"
#include "runtime/search/suppression.h"
#include "runtime/tables/lane_tables.h"

namespace sextant {

/// One object in a search. bins and lane_bins correspond; lane_bins were prepared for a floor <= threshold.
struct LaneTarget {
  const std::vector<ScoredBin>& bins;
  const std::vector<LaneBin>& lane_bins;
  const Constraint& constraint;
  double bounding_radius_m = 0.1;
  int max_detections = 1;
  double threshold = 0;
  /// Where given: the best other explanation of every found pose is proven, too (see runner_up.h).
  std::optional<RunnerUpOptions> runner_up{};
  /// Poses to begin with (see seeds.h); those that are not of this space are ignored.
  std::vector<LatticePose> seeds{};
  /// Detections of an earlier search: poses that they suppress do not count. With them there is no runner-up.
  std::vector<Box2> taken{};
};

struct LaneSearchProblem {
  const FrameTables& exact;
  const LaneTables& lanes;
  std::vector<LaneTarget> targets;
  /// True when the search must stop now; asked every few nodes, from any thread. Empty: never.
  std::function<bool()> expired;
  /// Nodes on the frontier beyond which subtrees are searched depth first; the answer stays exact.
  std::size_t most_waiting_nodes = 200000;
};

/// What a search did; not part of the answer and not the same for different numbers of threads.
struct LaneCounters {
  std::uint64_t roots = 0;         ///< nodes bounded before the search starts
  std::uint64_t coarse = 0;        ///< nodes bounded in the first stage, roots included
  std::uint64_t fine = 0;          ///< nodes bounded in later stages
  std::uint64_t parts = 0;         ///< parts looked up for 64 lanes
  std::uint64_t evaluations = 0;   ///< poses evaluated exactly
  std::uint64_t most_waiting = 0;  ///< nodes on the frontier at once, about
  std::uint64_t rival = 0;         ///< of coarse and fine: after the detections were known, for runner-ups
};

/// A part of the roots: every count-th tile, from index on.
struct LaneShare {
  std::size_t index = 0;
  std::size_t count = 1;
};

/// Keeps its buffers from frame to frame. One search at a time.
class LaneSearch {
 public:
  LaneSearch();
  ~LaneSearch();
  /// One outcome per target. upper_bound of a complete outcome: the score of the last detection where all
  /// that were asked for are found, else the threshold; a function of the answer alone.
  std::vector<SearchOutcome> run(const LaneSearchProblem& problem, WorkerPool& pool);
  const LaneCounters& counters() const;

  // The same search in pieces, on one thread, for one that several processes share (offline/mpi). Each begins
  // with its share of the roots and works on what is waiting; the pass is over when nothing waits anywhere;
  // then all advance with the best poses of all. What a search says at its end is the same as run() says.

  /// The problem must live until finish().
  void begin(const LaneSearchProblem& problem, LaneShare share);
  /// Roots of another share as well.
  void add_roots(LaneShare share);
  /// Expands up to that many nodes, best first.
  void step(std::size_t nodes);
  std::size_t waiting() const;
  /// Nodes and poses that only later passes may need.
  std::size_t kept() const;
  /// Takes the best nodes away, at most that many.
  std::vector<LaneNode> give(std::size_t most);
  void take(const std::vector<LaneNode>& nodes);
  /// Per object: the best pose of this pass so far; score -infinity: none.
  std::vector<ScoredPose> bests() const;
  /// A pose of this pass that another process found.
  void offer(std::size_t target, const ScoredPose& pose);
  /// Nothing waits anywhere: on to the next pass, with the best poses of all processes. False: all is proven.
  bool advance(const std::vector<ScoredPose>& bests);
  /// Per object: no pose that waits here scores higher; -infinity where none waits.
  std::vector<double> highest_waiting();
  /// Per object: no pose at all scores higher.
  std::vector<double> highest_possible() const;
  /// complete: advance() said so. Else elsewhere: per object, the highest that waits in other processes.
  std::vector<SearchOutcome> finish(bool complete, const std::vector<double>& elsewhere);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sextant
