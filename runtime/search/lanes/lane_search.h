// SPDX-License-Identifier: Apache-2.0
// The search engine: best-first branch and bound over lane nodes, several objects at once, on one or more
// threads. Its plain twin is branch_and_bound.h: the same poses, scores and certificates, bit for bit,
// whenever it completes.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "runtime/base/worker_pool.h"
#include "runtime/search/branch_and_bound.h"
#include "runtime/search/constraint.h"
#include "runtime/search/lanes/lane_bin.h"
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

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sextant
