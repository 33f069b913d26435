// SPDX-License-Identifier: Apache-2.0
#include "runtime/search/seeds.h"

#include "runtime/search/evaluate.h"

namespace sextant {
namespace {

constexpr int kMostSteps = 40;

}  // namespace

std::optional<double> score_of(const SearchProblem& problem, const LatticePose& pose) {
  if (pose.bin < 0 || static_cast<std::size_t>(pose.bin) >= problem.bins.size()) return std::nullopt;
  const ScoredBin& bin = problem.bins[static_cast<std::size_t>(pose.bin)];
  if (!problem.constraint.whole(pose.bin, bin.box).contains(pose) || !problem.constraint.contains(pose)) {
    return std::nullopt;
  }
  return evaluate(bin, problem.tables, pose);
}

std::optional<ScoredPose> climbed(const SearchProblem& problem, const LatticePose& start) {
  const auto score = score_of(problem, start);
  if (!score) return std::nullopt;
  ScoredPose best{start, *score};
  for (int step = 0; step < kMostSteps; ++step) {
    const ScoredPose from = best;
    for (std::size_t d = 0; d < kDimensions; ++d) {
      for (const int by : {-1, 1}) {
        LatticePose next = from.pose;
        next.at[d] = static_cast<std::int16_t>(next.at[d] + by);
        const auto there = score_of(problem, next);
        if (there && *there > best.score) best = {next, *there};
      }
    }
    if (best.pose == from.pose) break;
  }
  return best;
}

}  // namespace sextant
