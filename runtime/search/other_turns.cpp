// SPDX-License-Identifier: Apache-2.0
#include "runtime/search/other_turns.h"

#include <algorithm>
#include <cstdlib>

#include "runtime/search/seeds.h"

namespace sextant {
namespace {

/// Between two turns of an object that looks alike every symmetry_deg, degrees, 0..symmetry_deg / 2.
int turn_between(int a, int b, int symmetry_deg) {
  const int apart = std::abs(a - b) * kLatticeDegrees % symmetry_deg;
  return std::min(apart, symmetry_deg - apart);
}

}  // namespace

std::vector<ScoredPose> other_turns(const SearchProblem& problem, const LatticePose& found, int symmetry_deg,
                                    double least, std::size_t most) {
  std::vector<ScoredPose> out;
  if (symmetry_deg == 0) return out;
  const auto is_other = [&](const LatticePose& pose) {
    return turn_between(pose.at[kRz], found.at[kRz], symmetry_deg) > kSameTurnDeg;
  };
  for (std::size_t b = 0; b < problem.bins.size(); ++b) {
    const RotationBox& box = problem.bins[b].box;
    LatticePose pose = found;
    pose.bin = static_cast<std::int32_t>(b);
    std::optional<ScoredPose> best;
    for (int turn = first_angle(box.lo_deg[2]); turn <= last_angle(box.hi_deg[2]); ++turn) {
      pose.at[kRz] = static_cast<std::int16_t>(turn);
      if (!is_other(pose)) continue;
      const auto score = score_of(problem, pose);
      if (!score) break;  // the bin is of another tilt
      if (!best || *score > best->score) best = {pose, *score};
    }
    if (!best) continue;
    best = climbed(problem, best->pose);
    if (best && best->score >= least && is_other(best->pose)) out.push_back(*best);
  }
  std::stable_sort(out.begin(), out.end(),
                   [](const ScoredPose& a, const ScoredPose& b) { return a.score > b.score; });
  // Neighbouring bins may hold the same turn, one step on either side of their border.
  std::vector<ScoredPose> distinct;
  for (const ScoredPose& pose : out) {
    const bool same = std::any_of(distinct.begin(), distinct.end(), [&](const ScoredPose& other) {
      return turn_between(pose.pose.at[kRz], other.pose.at[kRz], symmetry_deg) <= kSameTurnDeg;
    });
    if (!same && distinct.size() < most) distinct.push_back(pose);
  }
  return distinct;
}

}  // namespace sextant
