// SPDX-License-Identifier: Apache-2.0
#include "offline/mesh/mass.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <tuple>

#include "offline/mesh/normals.h"

namespace sextant {
namespace {

constexpr double kMaxGap = 0.25;        // of the hull's mean radius
constexpr double kLeastFilling = 1e-3;  // of the hull's volume

bool is_inside(const ConvexHull& hull, const Eigen::Vector3d& p) {
  return std::all_of(hull.facets.begin(), hull.facets.end(), [&](const ConvexHull::Facet& facet) {
    return facet.normal.dot(p - hull.vertices[facet.corners[0]]) < 0;
  });
}

}  // namespace

double free_edge_length(const Mesh& mesh) {
  struct Edge {
    std::uint32_t lo, hi;
    int turns;  // +1 from lo to hi, -1 back
  };
  const std::vector<std::uint32_t> welded = welded_indices(mesh.vertices);
  std::vector<Edge> edges;
  for (const MeshPart& part : mesh.parts) {
    for (const auto& t : part.triangles) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = welded[t.at(k)];
        const std::uint32_t b = welded[t.at((k + 1) % 3)];
        if (a != b) edges.push_back({std::min(a, b), std::max(a, b), a < b ? 1 : -1});
      }
    }
  }
  std::sort(edges.begin(), edges.end(),
            [](const Edge& a, const Edge& b) { return std::tie(a.lo, a.hi) < std::tie(b.lo, b.hi); });
  double length = 0;
  for (std::size_t i = 0; i < edges.size();) {
    int turns = 0;
    std::size_t end = i;
    while (end < edges.size() && edges[end].lo == edges[i].lo && edges[end].hi == edges[i].hi)
      turns += edges[end++].turns;
    if (turns != 0) {
      length += std::abs(turns) *
                static_cast<double>((mesh.vertices[edges[i].hi] - mesh.vertices[edges[i].lo]).norm());
    }
    i = end;
  }
  return length;
}

Eigen::Vector3d centre_of_mass(const Mesh& mesh, const ConvexHull& hull) {
  const Solid solid = solid_of(hull);
  const double mean_radius = std::cbrt(solid.volume);
  if (free_edge_length(mesh) > kMaxGap * mean_radius) return solid.centre;
  double six_volumes = 0;
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  for (const MeshPart& part : mesh.parts) {
    for (const auto& t : part.triangles) {
      const Eigen::Vector3d a = mesh.vertices[t[0]].cast<double>() - solid.centre;
      const Eigen::Vector3d b = mesh.vertices[t[1]].cast<double>() - solid.centre;
      const Eigen::Vector3d c = mesh.vertices[t[2]].cast<double>() - solid.centre;
      const double v = a.dot(b.cross(c));
      six_volumes += v;
      moment += v * (a + b + c) / 4;
    }
  }
  if (std::abs(six_volumes) / 6 < kLeastFilling * solid.volume) return solid.centre;
  const Eigen::Vector3d centre = solid.centre + moment / six_volumes;
  return is_inside(hull, centre) ? centre : solid.centre;
}

}  // namespace sextant
