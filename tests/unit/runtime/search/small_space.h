// SPDX-License-Identifier: Apache-2.0
// A search problem small enough for brute force: few distances, a narrow table.
#pragma once

#include "random_problem.h"
#include "runtime/search/branch_and_bound.h"

namespace sextant {

struct SmallSpace {
  RandomProblem problem;
  TableConstraint standing;
  Constraint constraint;
  std::vector<ScoredBin> bins;
  std::vector<Region> space;

  explicit SmallSpace(std::uint64_t seed, int width = 24, int height = 18, double nearest = 0.9,
                      double farthest = 0.93)
      : problem(seed, width, height),
        standing(table()),
        constraint(problem.camera(), nearest, farthest, standing),
        bins(problem.bins()) {
    for (std::size_t i = 0; i < bins.size(); ++i) {
      // The few degrees around upright as this table shows it.
      bins[i].box.lo_deg = {-2, -42, 12 * static_cast<int>(i)};
      bins[i].box.hi_deg = {2, -38, 12 * static_cast<int>(i) + 4};
      space.push_back(constraint.whole(static_cast<int>(i), bins[i].box));
    }
  }
  TableConstraint table() {
    return {TableGeometry::from_pitch_roll(problem.uniform(0.65, 0.75), problem.uniform(-0.05, 0.05), 0.64),
            {0.02, 6 * kOneDegree},
            0.05};
  }
  SearchProblem search() const { return {bins, problem.tables(), constraint, 0.1}; }
};

}  // namespace sextant
