// SPDX-License-Identifier: Apache-2.0
#include "offline/synthesize/shapes.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <map>
#include <numbers>

namespace sextant {
namespace {

/// Signed volume by the divergence theorem: right only where the surface is closed and turned outwards.
double volume_of(const Mesh& mesh) {
  double six = 0;
  for (const auto& t : mesh.parts[0].triangles) {
    six += mesh.vertices[t[0]].cast<double>().dot(
        mesh.vertices[t[1]].cast<double>().cross(mesh.vertices[t[2]].cast<double>()));
  }
  return six / 6;
}

/// Every edge, by the places of its ends, is walked once in each direction.
void expect_closed(const Mesh& mesh) {
  std::map<std::array<int, 6>, int> walked;
  const auto place = [&](std::uint32_t v, int k) {
    return static_cast<int>(std::lround(mesh.vertices[v][k] * 1e5));
  };
  for (const auto& t : mesh.parts[0].triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = t[i];
      const std::uint32_t b = t[(i + 1) % 3];
      ++walked[{place(a, 0), place(a, 1), place(a, 2), place(b, 0), place(b, 1), place(b, 2)}];
    }
  }
  for (const auto& [edge, count] : walked) {
    EXPECT_EQ(1, count);
    const auto back = walked.find({edge[3], edge[4], edge[5], edge[0], edge[1], edge[2]});
    EXPECT_TRUE(back != walked.end() && back->second == 1);
  }
}

void expect_normals_outward(const Mesh& mesh) {
  for (const auto& t : mesh.parts[0].triangles) {
    const Eigen::Vector3f face = (mesh.vertices[t[1]] - mesh.vertices[t[0]])
                                     .cross(mesh.vertices[t[2]] - mesh.vertices[t[0]])
                                     .normalized();
    for (const std::uint32_t v : t) {
      EXPECT_NEAR(1, mesh.normals[v].norm(), 1e-5);
      EXPECT_GT(face.dot(mesh.normals[v]), 0.7);
    }
  }
}

TEST(Shapes, AreClosedStandOnTheTableAndHaveTheirVolume) {
  const double pi = std::numbers::pi;
  const std::vector<std::pair<Mesh, double>> shapes{{box_shape(0.1, 0.2, 0.3), 0.006},
                                                    {cylinder_shape(0.05, 0.2), pi * 0.0025 * 0.2},
                                                    {sphere_shape(0.06), 4 / 3.0 * pi * 0.000216},
                                                    {bottle_shape(0.04, 0.25), -1}};
  for (const auto& [mesh, volume] : shapes) {
    ASSERT_EQ(mesh.vertices.size(), mesh.normals.size());
    ASSERT_EQ(mesh.vertices.size(), mesh.uvs.size());
    ASSERT_EQ(mesh.vertices.size(), mesh.colours.size());
    expect_closed(mesh);
    expect_normals_outward(mesh);
    if (volume > 0) {
      EXPECT_NEAR(volume, volume_of(mesh), 0.02 * volume);
    } else {
      EXPECT_GT(volume_of(mesh), 0);
    }
    float lowest = 1;
    for (const Eigen::Vector3f& v : mesh.vertices) lowest = std::min(lowest, v.z());
    EXPECT_NEAR(0, lowest, 1e-6);
  }
}

}  // namespace
}  // namespace sextant
