// SPDX-License-Identifier: Apache-2.0
// Depth parts of one bin (Davies 2015, Proc. 6, the half about depth). Ours: they cover the whole disc around
// the object evenly, where the object is seen from all poses of the bin, from most (its rim), and where the
// table is seen beside it. So every bin explains the same patch of the image, and a hidden handle cannot win
// over a visible one by leaving it out.
#pragma once

#include <array>
#include <vector>

#include "offline/learn/part_statistics.h"
#include "offline/learn/view_scale.h"

namespace sextant {

/// positions: where parts may be. active: which of (1, rx, ry, rz) may have a coefficient. spacing_unit:
/// tangent * metre per unit of select_parts' spacing. What some pose of the box expects more than
/// kDepthReach (for objects of more than 0.25 m radius in proportion) before or behind the object's centre,
/// as a table seen at a grazing angle, is no part: clutter stands before it, and 16 bits would not hold it.
inline constexpr double kDepthReach = 0.5;  ///< metres
std::vector<DepthPart> learn_depth(const std::vector<TrainingView>& views,
                                   const std::vector<TestScene>& scenes, const LearnParameters& parameters,
                                   const Positions& positions, const RotationBox& box,
                                   std::array<bool, 4> active, double spacing_unit, double bounding_radius_m);

}  // namespace sextant
