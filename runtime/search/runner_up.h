// SPDX-License-Identifier: Apache-2.0
// How well the second explanation of the image fits: for every pose that was found, the best score of all
// feasible poses outside of the balls around the found ones that no better found one suppresses. A small
// difference to the found pose's own score means an ambiguous view; the answer is proven like the poses.
// This is the plain twin; the engine proves the same from the frontier that it already has.
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "runtime/search/pose_ball.h"
#include "runtime/search/suppression.h"

namespace sextant {

struct SearchProblem;
struct SearchOptions;
struct ScoredPose;
class WorkerPool;

/// What counts as another explanation, and how far below the answer to look for one.
struct RunnerUpOptions {
  BallSize ball;
  /// Score differences of interest: a larger one is only proven to be at least this.
  double most = std::numeric_limits<double>::infinity();
};

/// The best other explanation of one found pose.
struct RunnerUp {
  double score = 0;    ///< no other explanation scores higher
  bool exact = false;  ///< one has exactly this score; false: an upper bound only
};

/// Poses that do not count: those in a ball, and those that a detection suppresses.
struct Exclusion {
  std::vector<PoseBall> balls;
  std::vector<Box2> boxes;

  bool contains(const ScoredBin& bin, double focal, const LatticePose& pose) const;
  /// True only if contains() is true for every pose of the region.
  bool contains_all(const ScoredBin& bin, double focal, const Region& region) const;
};

/// Scores below this are of no interest as a rival of a pose that scores `found_score`.
double rival_floor(double found_score, double threshold, const RunnerUpOptions& options);

/// Plain search, one best-first search per found pose. found: the complete answer, best first. A rival
/// below max(threshold, found score - most) is only known to be below that.
std::vector<RunnerUp> plain_runner_ups(const SearchProblem& problem, const std::vector<ScoredPose>& found,
                                       const SearchOptions& options, const RunnerUpOptions& runner_up,
                                       WorkerPool& pool);

}  // namespace sextant
