// SPDX-License-Identifier: Apache-2.0
// Welzl's algorithm as nested loops: the sphere with 0, 1, 2 and 3 points known to lie on it. A point that
// is outside of the sphere of those before it lies on the sphere of all up to it.
#include "offline/mesh/bounding_sphere.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <random>
#include <span>

namespace sextant {
namespace {

using Points = std::span<const Eigen::Vector3d>;

// Relative to the size of the set: a point so little outside counts as inside. Many points of one sphere
// (a can's rim) would otherwise make the supporting set jump about for nothing.
constexpr double kTolerance = 1e-10;

bool outside(const Sphere& sphere, const Eigen::Vector3d& p, double scale) {
  return (p - sphere.centre).norm() > sphere.radius + kTolerance * scale;
}

// The smallest sphere that has all of 1 to 4 points on its surface, centre in their span. Where points
// nearly depend on each other, the pseudo-inverse keeps the centre close.
Sphere through(Points boundary) {
  const Eigen::Vector3d& origin = boundary[0];
  const auto n = static_cast<Eigen::Index>(boundary.size()) - 1;
  if (n == 0) return {origin, 0};
  Eigen::Matrix<double, Eigen::Dynamic, 3, 0, 3, 3> a(n, 3);
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 3, 1> b(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Vector3d d = boundary[static_cast<std::size_t>(i) + 1] - origin;
    a.row(i) = d.transpose();
    b(i) = 0.5 * d.squaredNorm();
  }
  const Eigen::Vector3d centre = a.completeOrthogonalDecomposition().solve(b);
  Sphere sphere{origin + centre, 0};
  for (const Eigen::Vector3d& p : boundary)
    sphere.radius = std::max(sphere.radius, (p - sphere.centre).norm());
  return sphere;
}

// Smallest sphere of `points` that has the first `known` of `boundary` on its surface.
Sphere smallest(Points points, std::array<Eigen::Vector3d, 4>& boundary, std::size_t known, double scale) {
  Sphere sphere = known > 0 ? through(Points(boundary).first(known)) : Sphere{points[0], 0};
  if (known == 4) return sphere;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!outside(sphere, points[i], scale)) continue;
    boundary.at(known) = points[i];
    sphere = smallest(points.first(i), boundary, known + 1, scale);
  }
  return sphere;
}

}  // namespace

Sphere smallest_sphere(std::vector<Eigen::Vector3d> points) {
  if (points.empty()) return {};
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& p : points) box.extend(p);
  // Around the middle of the box, so that rounding is relative to the size and not to the position.
  const Eigen::Vector3d middle = box.center();
  for (Eigen::Vector3d& p : points) p -= middle;
  std::mt19937_64 random(1);
  for (std::size_t i = points.size(); i > 1; --i) std::swap(points[i - 1], points[random() % i]);
  std::array<Eigen::Vector3d, 4> boundary;
  Sphere sphere = smallest(points, boundary, 0, box.diagonal().norm());
  double radius = 0;
  for (const Eigen::Vector3d& p : points) radius = std::max(radius, (p - sphere.centre).norm());
  return {sphere.centre + middle, radius};
}

}  // namespace sextant
