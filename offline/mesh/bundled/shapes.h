// SPDX-License-Identifier: Apache-2.0
// Surfaces of the bundled objects: turned on a lathe, bent from tube. Coordinates are rounded to 1e-3 so
// that no machine's last digit of a sine shows in the files.
#pragma once

#include <functional>
#include <vector>

#include "offline/mesh/mesh.h"

namespace sextant {

/// A point of a lathe profile: radius and height, any unit.
struct ProfilePoint {
  double radius;
  double height;
};

/// Colour of the surface at a fraction of the turn (0..1 from +x over +y) and between two profile points.
using LatheColour = std::function<Eigen::Vector3f(double turn, std::size_t band, double height)>;

/// Adds the surface that the profile makes when turned about z, as one part of `mesh`. The profile goes
/// from the bottom outside to wherever it ends (the surface's outer side is on the right of its way); radius
/// 0 closes it in a point. uv: u = fraction of the turn, v = 0 at the profile's first and 1 at its last
/// height. Each cell of the grid has one colour, that of its middle: edges of a print stay sharp.
void add_lathe(Mesh& mesh, const std::vector<ProfilePoint>& profile, int segments, const LatheColour& colour);

/// Adds a tube around a path, closed by caps at its ends, as one part. `section_turns`: number of sides.
void add_tube(Mesh& mesh, const std::vector<Eigen::Vector3d>& path, double half_width, double half_thickness,
              const Eigen::Vector3d& across, int sides, const Eigen::Vector3f& colour);

/// A profile that goes smoothly (Catmull-Rom) through points, `steps` pieces between two.
std::vector<ProfilePoint> smooth_profile(const std::vector<ProfilePoint>& points, int steps);

/// Rounds to 1e-3.
float rounded(double value);

}  // namespace sextant
