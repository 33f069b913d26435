// SPDX-License-Identifier: Apache-2.0
// Small meshes with known measures, standing as load_standing_object would leave them.
#pragma once

#include "offline/mesh/standing_object.h"

namespace sextant {

/// A box with 24 vertices (flat normals), half sizes in metres, centre in the origin; one colour per face.
inline Mesh box_object_mesh(double hx, double hy, double hz) {
  Mesh mesh;
  MeshPart part;
  for (int axis = 0; axis < 3; ++axis) {
    for (const float side : {-1.0F, 1.0F}) {
      const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
      for (const auto& [a, b] : {std::pair{-1.0F, -1.0F}, {1.0F, -1.0F}, {1.0F, 1.0F}, {-1.0F, 1.0F}}) {
        Eigen::Vector3f unit;
        unit[axis] = side;
        unit[(axis + 1) % 3] = a;
        unit[(axis + 2) % 3] = b;
        mesh.vertices.emplace_back(unit.cwiseProduct(Eigen::Vector3d(hx, hy, hz).cast<float>()));
        mesh.normals.emplace_back(side * Eigen::Vector3f::Unit(axis));
        mesh.colours.emplace_back(0.2F + 0.3F * static_cast<float>(axis), side > 0 ? 0.9F : 0.3F, 0.5F);
        mesh.uvs.emplace_back((a + 1) / 2, (b + 1) / 2);
      }
      if (side > 0) {
        part.triangles.push_back({base, base + 1, base + 2});
        part.triangles.push_back({base, base + 2, base + 3});
      } else {
        part.triangles.push_back({base, base + 2, base + 1});
        part.triangles.push_back({base, base + 3, base + 2});
      }
    }
  }
  mesh.parts.push_back(part);
  return mesh;
}

/// The box, standing.
inline StandingObject box_object(double hx, double hy, double hz, int symmetry_deg = 180) {
  StandingObject object;
  object.mesh = box_object_mesh(hx, hy, hz);
  object.bounding_radius_m = Eigen::Vector3d(hx, hy, hz).norm();
  object.centre_height_m = hz;
  object.symmetry_deg = symmetry_deg;
  object.geometric_symmetry_deg = symmetry_deg;
  return object;
}

}  // namespace sextant
