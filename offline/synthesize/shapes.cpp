// SPDX-License-Identifier: Apache-2.0
#include "offline/synthesize/shapes.h"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <numbers>

namespace sextant {
namespace {

std::uint32_t add_vertex(Mesh& mesh, const Eigen::Vector3d& p, const Eigen::Vector3d& normal, double u,
                         double v) {
  mesh.vertices.emplace_back(p.cast<float>());
  mesh.normals.emplace_back(normal.cast<float>());
  mesh.colours.emplace_back(1, 1, 1);
  mesh.uvs.emplace_back(static_cast<float>(u), static_cast<float>(v));
  return static_cast<std::uint32_t>(mesh.vertices.size() - 1);
}

/// A quad with corners origin + {0,1} a + {0,1} b, normal a x b.
void add_quad(Mesh& mesh, const Eigen::Vector3d& origin, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d normal = a.cross(b).normalized();
  const std::uint32_t first = add_vertex(mesh, origin, normal, 0, 0);
  add_vertex(mesh, origin + a, normal, 1, 0);
  add_vertex(mesh, origin + a + b, normal, 1, 1);
  add_vertex(mesh, origin + b, normal, 0, 1);
  mesh.parts[0].triangles.push_back({first, first + 1, first + 2});
  mesh.parts[0].triangles.push_back({first, first + 2, first + 3});
}

/// Outward normal (radius, z) of a profile's segment.
Eigen::Vector2d segment_normal(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  const Eigen::Vector2d step = (to - from).normalized();
  return {step.y(), -step.x()};
}

/// Normals at the two ends of segment i: shared with the neighbour where the corner is blunt.
std::array<Eigen::Vector2d, 2> end_normals(const std::vector<Eigen::Vector2d>& profile, std::size_t i) {
  const double blunt = std::cos(40 * std::numbers::pi / 180);
  const Eigen::Vector2d own = segment_normal(profile[i], profile[i + 1]);
  std::array<Eigen::Vector2d, 2> ends{own, own};
  if (i > 0) {
    const Eigen::Vector2d before = segment_normal(profile[i - 1], profile[i]);
    if (before.dot(own) > blunt) ends[0] = (before + own).normalized();
  }
  if (i + 2 < profile.size()) {
    const Eigen::Vector2d after = segment_normal(profile[i + 1], profile[i + 2]);
    if (after.dot(own) > blunt) ends[1] = (after + own).normalized();
  }
  return ends;
}

}  // namespace

Mesh box_shape(double size_x, double size_y, double size_z) {
  Mesh mesh;
  mesh.parts.resize(1);
  const Eigen::Vector3d x(size_x, 0, 0);
  const Eigen::Vector3d y(0, size_y, 0);
  const Eigen::Vector3d z(0, 0, size_z);
  const Eigen::Vector3d low = -(x + y) / 2;
  add_quad(mesh, low, x, z);
  add_quad(mesh, low + x, y, z);
  add_quad(mesh, low + x + y, -x, z);
  add_quad(mesh, low + y, -y, z);
  add_quad(mesh, low + z, x, y);
  add_quad(mesh, low, y, x);
  return mesh;
}

Mesh lathe_shape(const std::vector<Eigen::Vector2d>& profile, int segments) {
  Mesh mesh;
  mesh.parts.resize(1);
  double length = 0;
  for (std::size_t i = 0; i + 1 < profile.size(); ++i) length += (profile[i + 1] - profile[i]).norm();
  double walked = 0;
  for (std::size_t i = 0; i + 1 < profile.size(); ++i) {
    const auto normals = end_normals(profile, i);
    const double step = (profile[i + 1] - profile[i]).norm();
    std::uint32_t first = 0;
    for (int s = 0; s <= segments; ++s) {
      const double angle = 2 * std::numbers::pi * s / segments;
      const Eigen::Vector3d out(std::cos(angle), std::sin(angle), 0);
      for (std::size_t end = 0; end < 2; ++end) {
        const Eigen::Vector2d& p = profile[i + end];
        const std::uint32_t v =
            add_vertex(mesh, p.x() * out + p.y() * Eigen::Vector3d::UnitZ(),
                       normals[end].x() * out + normals[end].y() * Eigen::Vector3d::UnitZ(),
                       static_cast<double>(s) / segments, (walked + (end ? step : 0)) / length);
        if (s == 0 && end == 0) first = v;
      }
    }
    for (int s = 0; s < segments; ++s) {
      const std::uint32_t a = first + 2 * static_cast<std::uint32_t>(s);
      // A point of the profile on the axis gives one triangle of zero area: leave it out.
      if (profile[i].x() > 0) mesh.parts[0].triangles.push_back({a, a + 2, a + 1});
      if (profile[i + 1].x() > 0) mesh.parts[0].triangles.push_back({a + 2, a + 3, a + 1});
    }
    walked += step;
  }
  return mesh;
}

Mesh cylinder_shape(double radius, double height) {
  return lathe_shape({{0, 0}, {radius, 0}, {radius, height}, {0, height}});
}

Mesh sphere_shape(double radius) {
  constexpr int kRings = 24;
  std::vector<Eigen::Vector2d> profile;
  for (int i = 0; i <= kRings; ++i) {
    const double angle = std::numbers::pi * i / kRings;
    profile.emplace_back(i % kRings ? radius * std::sin(angle) : 0.0, radius * (1 - std::cos(angle)));
  }
  return lathe_shape(profile);
}

Mesh bottle_shape(double radius, double height) {
  const double neck = 0.35 * radius;
  std::vector<Eigen::Vector2d> profile{{0, 0}, {radius, 0}, {radius, 0.6 * height}};
  for (int i = 1; i <= 8; ++i) {
    const double t = i / 8.0;
    profile.emplace_back(neck + (radius - neck) * (0.5 + 0.5 * std::cos(std::numbers::pi * t)),
                         (0.6 + 0.22 * t) * height);
  }
  profile.emplace_back(neck, height);
  profile.emplace_back(0, height);
  return lathe_shape(profile);
}

Mesh rectangle_shape(double size_x, double size_y) {
  Mesh mesh;
  mesh.parts.resize(1);
  add_quad(mesh, Eigen::Vector3d(-size_x / 2, -size_y / 2, 0), Eigen::Vector3d(size_x, 0, 0),
           Eigen::Vector3d(0, size_y, 0));
  return mesh;
}

Mesh with_texture(Mesh mesh, cv::Mat texture) {
  mesh.textures = {std::move(texture)};
  for (MeshPart& part : mesh.parts) part.texture = 0;
  return mesh;
}

Mesh with_colour(Mesh mesh, const Eigen::Vector3f& colour) {
  for (MeshPart& part : mesh.parts) part.diffuse = colour;
  return mesh;
}

}  // namespace sextant
