// SPDX-License-Identifier: Apache-2.0
#include "offline/mesh/normals.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <limits>

#include "tests/unit/offline/mesh/test_files.h"

namespace sextant {
namespace {

TEST(Normals, ABoxKeepsItsEdges) {
  Mesh mesh = box_mesh(1, 2, 3);
  complete_normals(mesh);
  EXPECT_EQ(mesh.vertices.size(), 24U);
  for (const auto& t : mesh.parts[0].triangles) {
    const Eigen::Vector3f a = mesh.vertices[t[0]];
    const Eigen::Vector3f out = (mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a).normalized();
    for (const auto v : t) {
      EXPECT_LT((mesh.normals[v] - out).norm(), 1e-5F);
    }
  }
}

TEST(Normals, ABarrelIsSmoothAndItsRimSharp) {
  Mesh mesh = cylinder_mesh(1, 2, 24);
  complete_normals(mesh);
  EXPECT_EQ(mesh.vertices.size(), 2U + 4 * 24);
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Eigen::Vector3f& n = mesh.normals[i];
    if (std::abs(n.z()) > 0.5F) {
      EXPECT_NEAR(std::abs(n.z()), 1, 1e-5F);
    } else {
      const Eigen::Vector3f radial =
          Eigen::Vector3f(mesh.vertices[i].x(), mesh.vertices[i].y(), 0).normalized();
      EXPECT_LT((n - radial).norm(), 1e-4F);
    }
  }
}

TEST(Normals, UnweldedTrianglesAreSmoothedAlike) {
  const Mesh whole = cylinder_mesh(1, 2, 24);
  Mesh loose;
  loose.parts.resize(1);
  for (const auto& t : whole.parts[0].triangles) {
    std::array<std::uint32_t, 3> corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      corners.at(k) = static_cast<std::uint32_t>(loose.vertices.size());
      loose.vertices.push_back(whole.vertices[t.at(k)]);
      loose.normals.emplace_back(0, 0, 0);
      loose.colours.emplace_back(1, 1, 1);
      loose.uvs.emplace_back(0, 0);
    }
    loose.parts[0].triangles.push_back(corners);
  }
  complete_normals(loose);
  share_equal_vertices(loose);
  Mesh welded = whole;
  complete_normals(welded);
  EXPECT_EQ(loose.vertices.size(), welded.vertices.size());
  for (std::size_t i = 0; i < whole.parts[0].triangles.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto a = loose.parts[0].triangles[i].at(k);
      const auto b = welded.parts[0].triangles[i].at(k);
      EXPECT_EQ(loose.vertices[a], welded.vertices[b]);
      EXPECT_LT((loose.normals[a] - welded.normals[b]).norm(), 1e-4F);
    }
  }
}

TEST(Normals, GivenOnesStayAndBadOnesAreReplaced) {
  Mesh mesh = box_mesh(1, 1, 1);
  for (auto& n : mesh.normals) n = {0, 0, 2};
  mesh.normals[3] = {std::numeric_limits<float>::quiet_NaN(), 0, 0};
  complete_normals(mesh);
  EXPECT_EQ(mesh.normals[0], Eigen::Vector3f(0, 0, 1));
  for (const auto& n : mesh.normals) {
    EXPECT_NEAR(n.norm(), 1, 1e-5F);
  }
  for (const auto& t : mesh.parts[0].triangles) {
    for (const auto v : t) {
      EXPECT_TRUE(v >= 8 || v == 3 || mesh.normals[v] == Eigen::Vector3f(0, 0, 1));
    }
  }
}

TEST(Normals, SliversGetSomeUnitNormal) {
  Mesh mesh = box_mesh(1, 1, 1);
  mesh.parts[0].triangles = {{0, 1, 1}, {0, 2, 2}};
  mesh.vertices[1] = mesh.vertices[0];
  complete_normals(mesh);
  for (const auto& n : mesh.normals) {
    EXPECT_NEAR(n.norm(), 1, 1e-5F);
  }
}

}  // namespace
}  // namespace sextant
