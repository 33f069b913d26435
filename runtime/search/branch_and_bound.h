// SPDX-License-Identifier: Apache-2.0
// Best-first branch and bound over the feasible lattice poses of one object (Davies 2015, Procs. 29-30): the
// first pose taken from the frontier is the global optimum, the next ones follow in decreasing order.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "runtime/base/worker_pool.h"
#include "runtime/search/constraint.h"
#include "runtime/search/lattice.h"
#include "runtime/search/runner_up.h"
#include "runtime/search/scored_bin.h"
#include "runtime/tables/frame_tables.h"

namespace sextant {

/// What to search for.
struct SearchProblem {
  const std::vector<ScoredBin>& bins;
  const FrameTables& tables;
  const Constraint& constraint;
  double bounding_radius_m = 0.1;
};

struct SearchOptions {
  int max_detections = 1;  ///< 1..
  double threshold = 0;    ///< score that a detection must reach (>=)
  /// True when the search must stop now; asked once per batch. Empty: never.
  std::function<bool()> expired;
  Exclusion excluded;  ///< poses that do not count
};

/// A detection with its score.
struct ScoredPose {
  LatticePose pose;
  double score = 0;
};

/// What was found and what was proven about the rest.
struct SearchOutcome {
  std::vector<ScoredPose> found;  ///< best first; none suppresses another
  bool complete = false;          ///< false: the search expired, `found` is the best so far
  /// Every feasible pose that is neither found nor suppressed by a found one scores at most this.
  double upper_bound = 0;
  std::uint64_t nodes = 0;  ///< regions bounded
  /// Where asked for and the answer is complete: the best other explanation of every found pose.
  std::vector<RunnerUp> runner_ups;
};

/// Runs the search. With the same problem and options a completed search gives the same poses, scores and
/// upper bound for any number of threads.
SearchOutcome branch_and_bound(const SearchProblem& problem, const SearchOptions& options, WorkerPool& pool);

}  // namespace sextant
