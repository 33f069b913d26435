// SPDX-License-Identifier: Apache-2.0
// Warm start: poses of the previous frame as the first incumbents. A seed is a pose of this frame's space
// with this frame's score, so it can only save work, never change the answer.
#pragma once

#include <optional>

#include "runtime/search/branch_and_bound.h"

namespace sextant {

/// From a lattice pose uphill, one step in one dimension at a time, to where no step is better. Empty where
/// the start is not feasible in this frame.
std::optional<ScoredPose> climbed(const SearchProblem& problem, const LatticePose& start);

/// The pose's score, or nothing where it is not one of the space.
std::optional<double> score_of(const SearchProblem& problem, const LatticePose& pose);

}  // namespace sextant
