// SPDX-License-Identifier: Apache-2.0
// Convex hull of points in space, by Qhull (Barber, Dobkin, Huhdanpaa 1996).
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace sextant {

/// A closed convex surface of triangles.
struct ConvexHull {
  struct Facet {
    std::array<std::uint32_t, 3> corners{};  ///< counter-clockwise seen from outside
    std::array<std::uint32_t, 3>
        across{};                     ///< facet beyond the edge corners[k], corners[k + 1]; kNoFacet: none
    Eigen::Vector3d normal{0, 0, 1};  ///< unit, outwards (of the flat face that it is a piece of)
  };
  static constexpr std::uint32_t kNoFacet = ~std::uint32_t{0};
  std::vector<Eigen::Vector3d> vertices;
  std::vector<Facet> facets;
};

/// The hull; empty where the points are flat or fewer than four. Beyond 100,000 points only the outermost
/// in each of 98,304 directions from their middle are used (the hull then stays inside the true one by less
/// than 1e-3 of the size). Equal input gives equal output.
std::optional<ConvexHull> convex_hull(const std::vector<Eigen::Vector3d>& points);

/// Volume and centre of mass of the solid that the hull bounds.
struct Solid {
  double volume = 0;
  Eigen::Vector3d centre{0, 0, 0};
};
Solid solid_of(const ConvexHull& hull);

}  // namespace sextant
