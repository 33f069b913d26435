// SPDX-License-Identifier: Apache-2.0
// Poses that stand where a found one stands, turned about the object's vertical, and score nearly as well. A
// score of a hundred parts may not tell which way an object is turned (a mug's handle is three of them); what
// looks at every pixel can choose among these.
#pragma once

#include <vector>

#include "runtime/search/branch_and_bound.h"

namespace sextant {

/// Turns nearer than this to the found one, degrees, are the same explanation.
inline constexpr int kSameTurnDeg = 15;

/// The best pose of every bin of the found pose's tilt, climbed from its best turn, that scores at least
/// `least` and is turned by more than kSameTurnDeg: best first, at most `most`. symmetry_deg: of the model.
std::vector<ScoredPose> other_turns(const SearchProblem& problem, const LatticePose& found, int symmetry_deg,
                                    double least, std::size_t most);

}  // namespace sextant
