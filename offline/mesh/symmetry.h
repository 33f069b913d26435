// SPDX-License-Identifier: Apache-2.0
// By which turns about its vertical axis an object looks the same.
#pragma once

#include "offline/mesh/mesh.h"

namespace sextant {

/// 0: the same after any turn; 90, 180: after these; 360: after none.
struct TurnSymmetry {
  int with_print_deg = 360;  ///< shape and colours
  int of_shape_deg = 360;    ///< shape alone; never less symmetric than with the print
};

/// Compares the surface with itself turned about the z axis through the origin, at 5000 points spread over
/// it. The shape is the same if a turned point lies within 5 % of `bounding_radius_m` of the surface and 99 %
/// of them within 2 %; the print, if at most 2 % of the points then see a colour that differs by more than
/// 0.15 (of 1) in any channel. So a print must cover 2 % of the surface to count. A prism of 16 or
/// more sides counts as round. Deterministic.
TurnSymmetry detect_turn_symmetry(const Mesh& mesh, double bounding_radius_m);

/// Colour (RGB, 0..1) of a mesh at a place of a triangle of one part: vertex colour times diffuse times
/// texture (bilinear, repeated beyond 0..1). Weights are barycentric.
Eigen::Vector3f surface_colour(const Mesh& mesh, const MeshPart& part,
                               const std::array<std::uint32_t, 3>& triangle, const Eigen::Vector3d& weights);

}  // namespace sextant
