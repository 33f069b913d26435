// SPDX-License-Identifier: Apache-2.0
// Closest point on a triangle surface: a bounding-volume tree over its triangles.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "offline/mesh/mesh.h"

namespace sextant {

/// Triangles of all parts of a mesh in one list, with the part that each came from.
struct TriangleList {
  std::vector<Eigen::Vector3f> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::uint32_t> part;  ///< of Mesh::parts, per triangle
};
TriangleList triangle_list(const Mesh& mesh);

/// A place on a surface.
struct SurfacePoint {
  std::uint32_t triangle = 0;
  Eigen::Vector3d barycentric{1, 0, 0};  ///< weights of the triangle's corners
  Eigen::Vector3d position{0, 0, 0};
};

/// Immutable after construction; safe to use from many threads.
class SurfaceIndex {
 public:
  SurfaceIndex(std::vector<Eigen::Vector3f> vertices, std::vector<std::array<std::uint32_t, 3>> triangles);

  /// The closest point of the surface (the first in the tree's order among equals). O(log n) on ordinary
  /// surfaces; gives up after a fixed number of nodes on hostile ones (then the point found so far, which
  /// may be too far away but never too close). The surface must not be empty.
  SurfacePoint closest(const Eigen::Vector3d& point) const;
  double distance(const Eigen::Vector3d& point) const { return (closest(point).position - point).norm(); }

  const std::vector<Eigen::Vector3f>& vertices() const { return vertices_; }
  const std::vector<std::array<std::uint32_t, 3>>& triangles() const { return triangles_; }

 private:
  struct Node {
    Eigen::Vector3f lo, hi;
    std::uint32_t first = 0;  // leaf: first triangle in order_; inner: left child (right is the next one)
    std::uint32_t count = 0;  // leaf: triangles; inner: 0
  };
  void build(std::uint32_t node, std::uint32_t first, std::uint32_t count);

  std::vector<Eigen::Vector3f> vertices_;
  std::vector<std::array<std::uint32_t, 3>> triangles_;
  std::vector<Eigen::Vector3f> centres_;  // only while building
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

/// The closest point of one triangle as barycentric weights; a triangle may be a line or a point.
Eigen::Vector3d closest_barycentric(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                                    const Eigen::Vector3d& b, const Eigen::Vector3d& c);

/// `count` points spread evenly over the surface: area-weighted, by a low-discrepancy sequence
/// (R2, Roberts 2018), so the same surface gives the same points.
std::vector<SurfacePoint> spread_points(const std::vector<Eigen::Vector3f>& vertices,
                                        const std::vector<std::array<std::uint32_t, 3>>& triangles,
                                        std::size_t count);

}  // namespace sextant
