// SPDX-License-Identifier: Apache-2.0
#include "offline/mesh/surface_index.h"

#include <gtest/gtest.h>

#include <random>

#include "offline/mesh/bundled/bundled_meshes.h"
#include "tests/unit/offline/mesh/test_files.h"

namespace sextant {
namespace {

using Eigen::Vector3d;

TEST(SurfaceIndex, ClosestOnATriangleBeatsEverySample) {
  std::mt19937_64 random(41);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> unit(0, 1);
  const auto point = [&] { return Vector3d(normal(random), normal(random), normal(random)); };
  for (int i = 0; i < 2000; ++i) {
    const Vector3d a = point();
    const Vector3d b = i % 7 == 0 ? a : point();  // a sliver
    const Vector3d c = i % 11 == 0 ? Vector3d(0.5 * (a + b)) : point();
    const Vector3d p = point();
    const Vector3d w = closest_barycentric(p, a, b, c);
    ASSERT_NEAR(w.sum(), 1, 1e-9);
    ASSERT_GE(w.minCoeff(), -1e-12);
    const double distance = (w[0] * a + w[1] * b + w[2] * c - p).norm();
    for (int k = 0; k < 60; ++k) {
      double u = k < 20 ? 0 : unit(random);
      double v = k % 20 < 5 ? 0 : unit(random);
      if (u + v > 1) {
        u = 1 - u;
        v = 1 - v;
      }
      ASSERT_LE(distance, ((1 - u - v) * a + u * b + v * c - p).norm() + 1e-9);
    }
  }
}

TEST(SurfaceIndex, TreeAgreesWithTryingAllTriangles) {
  const TriangleList list = triangle_list(bottle());
  const SurfaceIndex index(list.vertices, list.triangles);
  std::mt19937_64 random(42);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 200; ++i) {
    const Vector3d p(60 * normal(random), 60 * normal(random), 120 + 120 * normal(random));
    double best = 1e9;
    for (const auto& t : list.triangles) {
      const Vector3d a = list.vertices[t[0]].cast<double>();
      const Vector3d b = list.vertices[t[1]].cast<double>();
      const Vector3d c = list.vertices[t[2]].cast<double>();
      const Vector3d w = closest_barycentric(p, a, b, c);
      best = std::min(best, (w[0] * a + w[1] * b + w[2] * c - p).norm());
    }
    EXPECT_NEAR(index.distance(p), best, 1e-9);
  }
}

// 200,000 times the same triangle: no tree helps; the answer still comes, and is a point of the surface.
TEST(SurfaceIndex, HostileSurfacesDoNotHang) {
  const std::vector<Eigen::Vector3f> vertices{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const std::vector<std::array<std::uint32_t, 3>> triangles(200'000, {0, 1, 2});
  const SurfaceIndex index(vertices, triangles);
  for (int i = 0; i < 1000; ++i) {
    const SurfacePoint found = index.closest({0.8, 0.8, 0.1 * i});
    EXPECT_NEAR(found.position.z(), 0, 1e-12);
    EXPECT_NEAR(found.position.x(), 0.5, 1e-9);
  }
}

TEST(SurfaceIndex, PointsAreSpreadByArea) {
  const TriangleList list = triangle_list(box_mesh(1, 2, 3));
  const auto points = spread_points(list.vertices, list.triangles, 22'000);
  ASSERT_EQ(points.size(), 22'000U);
  int on_x = 0;
  int upper_half = 0;
  for (const SurfacePoint& p : points) {
    EXPECT_NEAR(p.barycentric.sum(), 1, 1e-12);
    EXPECT_GE(p.barycentric.minCoeff(), 0);
    EXPECT_NEAR((p.position.cwiseAbs() - Vector3d(0.5, 1, 1.5)).maxCoeff(), 0, 1e-6);
    on_x += std::abs(std::abs(p.position.x()) - 0.5) < 1e-6;
    upper_half += p.position.z() > 0;
  }
  EXPECT_NEAR(on_x, 12'000, 60);  // 12 of 22 square units
  EXPECT_NEAR(upper_half, 11'000, 120);
}

}  // namespace
}  // namespace sextant
