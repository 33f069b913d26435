// SPDX-License-Identifier: Apache-2.0
#include "offline/mesh/surface_index.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace sextant {
namespace {

constexpr std::uint32_t kLeafTriangles = 4;
constexpr int kMaxNodesPerQuery = 20000;

double squared_distance_to_box(const Eigen::Vector3d& p, const Eigen::Vector3f& lo,
                               const Eigen::Vector3f& hi) {
  const Eigen::Vector3d below = (lo.cast<double>() - p).cwiseMax(0);
  const Eigen::Vector3d above = (p - hi.cast<double>()).cwiseMax(0);
  return (below + above).squaredNorm();
}

}  // namespace

TriangleList triangle_list(const Mesh& mesh) {
  TriangleList list;
  list.vertices = mesh.vertices;
  for (std::size_t i = 0; i < mesh.parts.size(); ++i) {
    const auto& triangles = mesh.parts[i].triangles;
    list.triangles.insert(list.triangles.end(), triangles.begin(), triangles.end());
    list.part.resize(list.triangles.size(), static_cast<std::uint32_t>(i));
  }
  return list;
}

Eigen::Vector3d closest_barycentric(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                                    const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const Eigen::Vector3d ab = b - a;
  const Eigen::Vector3d ac = c - a;
  const Eigen::Vector3d normal = ab.cross(ac);
  const double doubled_area_squared = normal.squaredNorm();
  constexpr double kSliver = 1e-20;  // of the squares of the sides: below, the plane is not known
  if (doubled_area_squared > kSliver * ab.squaredNorm() * ac.squaredNorm()) {
    const double v = (p - a).cross(ac).dot(normal) / doubled_area_squared;
    const double w = ab.cross(p - a).dot(normal) / doubled_area_squared;
    if (v >= 0 && w >= 0 && v + w <= 1) return {1 - v - w, v, w};
  }
  // Outside of the triangle (or it is a line): the closest point lies on a side.
  const std::array<Eigen::Vector3d, 3> corner{a, b, c};
  Eigen::Vector3d best(1, 0, 0);
  double best_squared = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    const Eigen::Vector3d& from = corner.at(static_cast<std::size_t>(k));
    const Eigen::Vector3d along = corner.at(static_cast<std::size_t>(next)) - from;
    const double length_squared = along.squaredNorm();
    const double t = length_squared > 0 ? std::clamp(along.dot(p - from) / length_squared, 0.0, 1.0) : 0.0;
    const double squared = (from + t * along - p).squaredNorm();
    if (squared >= best_squared) continue;
    best_squared = squared;
    best.setZero();
    best[k] = 1 - t;
    best[next] = t;
  }
  return best;
}

SurfaceIndex::SurfaceIndex(std::vector<Eigen::Vector3f> vertices,
                           std::vector<std::array<std::uint32_t, 3>> triangles)
    : vertices_(std::move(vertices)), triangles_(std::move(triangles)), order_(triangles_.size()) {
  std::iota(order_.begin(), order_.end(), 0U);
  for (const auto& t : triangles_) {
    centres_.push_back((vertices_[t[0]] + vertices_[t[1]] + vertices_[t[2]]) / 3);
  }
  nodes_.emplace_back();
  build(0, 0, static_cast<std::uint32_t>(order_.size()));
  centres_ = {};
}

void SurfaceIndex::build(std::uint32_t node, std::uint32_t first, std::uint32_t count) {
  Eigen::AlignedBox3f box;
  Eigen::AlignedBox3f centres;
  for (std::uint32_t i = first; i < first + count; ++i) {
    for (const std::uint32_t v : triangles_[order_[i]]) box.extend(vertices_[v]);
    centres.extend(centres_[order_[i]]);
  }
  nodes_[node].lo = box.min();
  nodes_[node].hi = box.max();
  if (count <= kLeafTriangles) {
    nodes_[node].first = first;
    nodes_[node].count = count;
    return;
  }
  int axis = 0;
  centres.sizes().maxCoeff(&axis);
  const auto less = [&](std::uint32_t a, std::uint32_t b) {
    const float ca = centres_[a][axis];
    const float cb = centres_[b][axis];
    return ca != cb ? ca < cb : a < b;
  };
  const auto begin = order_.begin() + first;
  std::nth_element(begin, begin + count / 2, begin + count, less);
  const auto left = static_cast<std::uint32_t>(nodes_.size());
  nodes_.resize(nodes_.size() + 2);
  nodes_[node].first = left;
  nodes_[node].count = 0;
  build(left, first, count / 2);
  build(left + 1, first + count / 2, count - count / 2);
}

SurfacePoint SurfaceIndex::closest(const Eigen::Vector3d& point) const {
  SurfacePoint best;
  double best_squared = std::numeric_limits<double>::infinity();
  struct Visit {
    std::uint32_t node;
    double squared;
  };
  std::array<Visit, 64> stack{};  // the tree is balanced: its depth is at most 22
  std::size_t depth = 0;
  stack.at(depth++) = {0, 0};
  for (int visited = 0; depth > 0 && visited < kMaxNodesPerQuery; ++visited) {
    const Visit visit = stack.at(--depth);
    if (visit.squared >= best_squared) continue;
    const Node& node = nodes_[visit.node];
    if (node.count == 0) {
      const Node& left = nodes_[node.first];
      const Node& right = nodes_[node.first + 1];
      Visit near{node.first, squared_distance_to_box(point, left.lo, left.hi)};
      Visit far{node.first + 1, squared_distance_to_box(point, right.lo, right.hi)};
      if (far.squared < near.squared) std::swap(near, far);
      stack.at(depth++) = far;
      stack.at(depth++) = near;
      continue;
    }
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      const auto& t = triangles_[order_[i]];
      const Eigen::Vector3d a = vertices_[t[0]].cast<double>();
      const Eigen::Vector3d b = vertices_[t[1]].cast<double>();
      const Eigen::Vector3d c = vertices_[t[2]].cast<double>();
      const Eigen::Vector3d weights = closest_barycentric(point, a, b, c);
      const Eigen::Vector3d position = weights[0] * a + weights[1] * b + weights[2] * c;
      const double squared = (position - point).squaredNorm();
      if (squared < best_squared) {
        best_squared = squared;
        best = {order_[i], weights, position};
      }
    }
  }
  return best;
}

std::vector<SurfacePoint> spread_points(const std::vector<Eigen::Vector3f>& vertices,
                                        const std::vector<std::array<std::uint32_t, 3>>& triangles,
                                        std::size_t count) {
  std::vector<double> area_up_to;
  double area = 0;
  const auto corner = [&](std::size_t triangle, std::size_t k) -> Eigen::Vector3d {
    return vertices[triangles[triangle].at(k)].cast<double>();
  };
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    area += 0.5 * (corner(i, 1) - corner(i, 0)).cross(corner(i, 2) - corner(i, 0)).norm();
    area_up_to.push_back(area);
  }
  std::vector<SurfacePoint> points;
  if (!(area > 0)) return points;
  // The plastic number's powers: the two-dimensional golden ratio.
  constexpr double kA = 0.7548776662466927;
  constexpr double kB = 0.5698402909980532;
  for (std::size_t i = 0; i < count; ++i) {
    const double at = area * (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    const auto found = std::lower_bound(area_up_to.begin(), area_up_to.end(), at) - area_up_to.begin();
    const std::size_t triangle = std::min(static_cast<std::size_t>(found), triangles.size() - 1);
    double u = std::fmod(0.5 + kA * static_cast<double>(i + 1), 1.0);
    double v = std::fmod(0.5 + kB * static_cast<double>(i + 1), 1.0);
    if (u + v > 1) {
      u = 1 - u;
      v = 1 - v;
    }
    SurfacePoint point{static_cast<std::uint32_t>(triangle), {1 - u - v, u, v}, {}};
    point.position =
        point.barycentric[0] * corner(triangle, 0) + u * corner(triangle, 1) + v * corner(triangle, 2);
    points.push_back(point);
  }
  return points;
}

}  // namespace sextant
