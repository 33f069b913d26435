// SPDX-License-Identifier: Apache-2.0
// The smallest sphere around points (Welzl 1991, "Smallest enclosing disks (balls and ellipsoids)").
#pragma once

#include <Eigen/Core>
#include <vector>

namespace sextant {

struct Sphere {
  Eigen::Vector3d centre{0, 0, 0};
  double radius = 0;
};

/// The smallest enclosing sphere. Exact up to rounding: the radius is at most 1e-6 (relative) above the
/// smallest one, and every point lies inside. Expected linear time; the points' order does not matter
/// beyond rounding, and equal input gives equal output. No points: radius 0 at the origin.
Sphere smallest_sphere(std::vector<Eigen::Vector3d> points);

}  // namespace sextant
