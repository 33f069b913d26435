// SPDX-License-Identifier: Apache-2.0
// The oracle: every feasible lattice pose of a space, evaluated. What the fast search proves must be what
// this finds (METHOD.md section 6).
#pragma once

#include <vector>

#include "runtime/search/branch_and_bound.h"

namespace sextant {

/// All feasible poses of `space` (one region per entry) with score >= threshold, best first, ties by the
/// total order; suppressed ones (IoU > 0.5 with a better one that is kept) are left out, at most
/// max_detections kept. upper_bound: the best score of what is neither kept nor suppressed, at least the
/// threshold.
SearchOutcome brute_force(const SearchProblem& problem, const std::vector<Region>& space,
                          const SearchOptions& options);

/// Calls visit(pose) for every lattice pose of a region, in the total order.
template <typename Visit>
void for_each_pose(const Region& r, Visit visit) {
  if (r.empty()) return;
  LatticePose pose{r.bin, r.lo};
  while (true) {
    visit(pose);
    int d = kDimensions - 1;
    while (d >= 0 && pose.at[static_cast<std::size_t>(d)] == r.hi[static_cast<std::size_t>(d)]) {
      pose.at[static_cast<std::size_t>(d)] = r.lo[static_cast<std::size_t>(d)];
      --d;
    }
    if (d < 0) return;
    ++pose.at[static_cast<std::size_t>(d)];
  }
}

}  // namespace sextant
