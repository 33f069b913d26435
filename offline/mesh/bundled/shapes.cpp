// SPDX-License-Identifier: Apache-2.0
#include "offline/mesh/bundled/shapes.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace sextant {
namespace {

std::uint32_t add_vertex(Mesh& mesh, const Eigen::Vector3d& p, const Eigen::Vector3f& colour,
                         const Eigen::Vector2f& uv = {0, 0}) {
  mesh.vertices.emplace_back(rounded(p.x()), rounded(p.y()), rounded(p.z()));
  mesh.normals.emplace_back(0, 0, 0);
  mesh.colours.push_back(colour);
  mesh.uvs.push_back(uv);
  return static_cast<std::uint32_t>(mesh.vertices.size()) - 1;
}

}  // namespace

float rounded(double value) {
  return static_cast<float>(static_cast<double>(std::lround(value * 1000)) / 1000);
}

void add_lathe(Mesh& mesh, const std::vector<ProfilePoint>& profile, int segments,
               const LatheColour& colour) {
  MeshPart part;
  const double low = profile.front().height;
  const double high = profile.back().height;
  const auto corner = [&](const ProfilePoint& p, int segment, const Eigen::Vector3f& paint) {
    const double turn = 2 * std::numbers::pi * (segment % segments) / segments;
    const double v = high != low ? (p.height - low) / (high - low) : 0;
    return add_vertex(mesh, {p.radius * std::cos(turn), p.radius * std::sin(turn), p.height}, paint,
                      {static_cast<float>(segment) / static_cast<float>(segments), rounded(v)});
  };
  for (std::size_t band = 0; band + 1 < profile.size(); ++band) {
    const ProfilePoint& from = profile[band];
    const ProfilePoint& to = profile[band + 1];
    for (int s = 0; s < segments; ++s) {
      const Eigen::Vector3f paint = colour((s + 0.5) / segments, band, 0.5 * (from.height + to.height));
      const std::uint32_t a = corner(from, s, paint);
      const std::uint32_t b = corner(from, s + 1, paint);
      const std::uint32_t c = corner(to, s + 1, paint);
      const std::uint32_t d = corner(to, s, paint);
      if (from.radius > 0) part.triangles.push_back({a, b, c});
      if (to.radius > 0) part.triangles.push_back({a, c, d});
    }
  }
  mesh.parts.push_back(std::move(part));
}

void add_tube(Mesh& mesh, const std::vector<Eigen::Vector3d>& path, double half_width, double half_thickness,
              const Eigen::Vector3d& across, int sides, const Eigen::Vector3f& colour) {
  MeshPart part;
  const auto n = path.size();
  std::vector<std::vector<std::uint32_t>> rings;
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector3d along = (path[std::min(i + 1, n - 1)] - path[i == 0 ? 0 : i - 1]).normalized();
    const Eigen::Vector3d out = along.cross(across).normalized();
    rings.emplace_back();
    for (int s = 0; s < sides; ++s) {
      const double turn = 2 * std::numbers::pi * s / sides;
      rings.back().push_back(add_vertex(
          mesh, path[i] + half_thickness * std::cos(turn) * out - half_width * std::sin(turn) * across,
          colour));
    }
  }
  const auto sides_u = static_cast<std::size_t>(sides);
  for (std::size_t i = 0; i + 1 < n; ++i) {
    for (std::size_t s = 0; s < sides_u; ++s) {
      const std::size_t next = (s + 1) % sides_u;
      part.triangles.push_back({rings[i][s], rings[i][next], rings[i + 1][next]});
      part.triangles.push_back({rings[i][s], rings[i + 1][next], rings[i + 1][s]});
    }
  }
  const std::uint32_t start = add_vertex(mesh, path.front(), colour);
  const std::uint32_t end = add_vertex(mesh, path.back(), colour);
  for (std::size_t s = 0; s < sides_u; ++s) {
    const std::size_t next = (s + 1) % sides_u;
    part.triangles.push_back({start, rings.front()[next], rings.front()[s]});
    part.triangles.push_back({end, rings.back()[s], rings.back()[next]});
  }
  mesh.parts.push_back(std::move(part));
}

std::vector<ProfilePoint> smooth_profile(const std::vector<ProfilePoint>& points, int steps) {
  std::vector<ProfilePoint> out;
  const std::size_t n = points.size();
  for (std::size_t i = 0; i + 1 < n; ++i) {
    const ProfilePoint& p0 = points[i == 0 ? 0 : i - 1];
    const ProfilePoint& p1 = points[i];
    const ProfilePoint& p2 = points[i + 1];
    const ProfilePoint& p3 = points[std::min(i + 2, n - 1)];
    for (int k = 0; k < steps; ++k) {
      const double t = static_cast<double>(k) / steps;
      const auto through = [t](double a, double b, double c, double d) {
        return 0.5 * (2 * b + (c - a) * t + (2 * a - 5 * b + 4 * c - d) * t * t +
                      (3 * b - a - 3 * c + d) * t * t * t);
      };
      out.push_back({through(p0.radius, p1.radius, p2.radius, p3.radius),
                     through(p0.height, p1.height, p2.height, p3.height)});
    }
  }
  out.push_back(points.back());
  return out;
}

}  // namespace sextant
