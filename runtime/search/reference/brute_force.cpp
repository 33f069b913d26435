// SPDX-License-Identifier: Apache-2.0
#include "runtime/search/reference/brute_force.h"

#include <algorithm>

#include "runtime/search/evaluate.h"
#include "runtime/search/suppression.h"

namespace sextant {

SearchOutcome brute_force(const SearchProblem& problem, const std::vector<Region>& space,
                          const SearchOptions& options) {
  SearchOutcome outcome;
  outcome.complete = true;
  outcome.upper_bound = options.threshold;
  std::vector<ScoredPose> all;
  for (const Region& region : space) {
    const ScoredBin& bin = problem.bins[static_cast<std::size_t>(region.bin)];
    for_each_pose(region, [&](const LatticePose& pose) {
      ++outcome.nodes;
      if (!problem.constraint.contains(pose)) return;
      const double score = evaluate(bin, problem.tables, pose);
      if (score >= options.threshold) all.push_back({pose, score});
    });
  }
  std::sort(all.begin(), all.end(), [](const ScoredPose& a, const ScoredPose& b) {
    return a.score != b.score ? a.score > b.score : a.pose < b.pose;
  });
  const double focal = problem.tables.camera().focal;
  std::vector<Box2> kept;
  for (const ScoredPose& p : all) {
    const Box2 box = box_of(problem.bins[static_cast<std::size_t>(p.pose.bin)], focal, p.pose);
    const bool hidden = std::any_of(kept.begin(), kept.end(), [&](const Box2& other) {
      return intersection_over_union(box, other) > kSuppressionIou;
    });
    if (hidden) continue;
    if (static_cast<int>(outcome.found.size()) == options.max_detections) {
      outcome.upper_bound = p.score;
      break;
    }
    outcome.found.push_back(p);
    kept.push_back(box);
  }
  return outcome;
}

}  // namespace sextant
