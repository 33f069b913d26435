// SPDX-License-Identifier: Apache-2.0
#include "runtime/search/runner_up.h"

#include <algorithm>

#include "runtime/search/branch_and_bound.h"

namespace sextant {

bool Exclusion::contains(const ScoredBin& bin, double focal, const LatticePose& pose) const {
  if (!boxes.empty()) {
    const Box2 box = box_of(bin, focal, pose);
    if (std::any_of(boxes.begin(), boxes.end(), [&](const Box2& other) {
          return intersection_over_union(box, other) > kSuppressionIou;
        })) {
      return true;
    }
  }
  return std::any_of(balls.begin(), balls.end(), [&](const PoseBall& ball) { return ball.contains(pose); });
}

bool Exclusion::contains_all(const ScoredBin& bin, double focal, const Region& region) const {
  return std::any_of(boxes.begin(), boxes.end(),
                     [&](const Box2& box) { return suppressed_everywhere(bin, focal, region, box); }) ||
         std::any_of(balls.begin(), balls.end(),
                     [&](const PoseBall& ball) { return ball.contains_all(region); });
}

double rival_floor(double found_score, double threshold, const RunnerUpOptions& options) {
  return std::max(threshold, found_score - options.most);
}

std::vector<RunnerUp> plain_runner_ups(const SearchProblem& problem, const std::vector<ScoredPose>& found,
                                       const SearchOptions& options, const RunnerUpOptions& runner_up,
                                       WorkerPool& pool) {
  const double focal = problem.tables.camera().focal;
  SearchOptions one = options;
  one.max_detections = 1;
  for (const ScoredPose& f : found) {
    one.excluded.balls.emplace_back(problem.constraint.camera(), f.pose, runner_up.ball);
  }
  std::vector<RunnerUp> out;
  for (const ScoredPose& f : found) {
    one.threshold = rival_floor(f.score, options.threshold, runner_up);
    const SearchOutcome outcome = branch_and_bound(problem, one, pool);
    if (outcome.complete && !outcome.found.empty()) {
      out.push_back({outcome.found[0].score, true});
    } else {
      const double best = outcome.found.empty() ? outcome.upper_bound : outcome.found[0].score;
      out.push_back({std::max(best, outcome.upper_bound), false});
    }
    one.excluded.boxes.push_back(box_of(problem.bins[static_cast<std::size_t>(f.pose.bin)], focal, f.pose));
  }
  return out;
}

}  // namespace sextant
