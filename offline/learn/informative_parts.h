// SPDX-License-Identifier: Apache-2.0
// Of the edges that were put to the test in scenes, those that say most about where the object is. Fewer but
// sharper parts find more right poses than many vague ones (docs/SCORING.md), and bound tighter.
#pragma once

#include <cstddef>
#include <vector>

#include "runtime/model/object_model.h"

namespace sextant {

/// What an edge says about its place: the curvature of its log-likelihood ratio over the range in which it is
/// recognised, (gain - out) / spread, 1 / (tangent * metre)^2.
double information_of(const VisualPart& part);

/// Keeps the `most` parts with the most information, in their order; their weights grow so that the edges
/// together say as much as before.
void keep_most_informative(std::vector<VisualPart>& parts, std::size_t most);

}  // namespace sextant
