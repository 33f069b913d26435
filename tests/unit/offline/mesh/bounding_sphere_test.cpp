// SPDX-License-Identifier: Apache-2.0
#include "offline/mesh/bounding_sphere.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>

namespace sextant {
namespace {

using Eigen::Vector3d;
using Points = std::vector<Vector3d>;

// A lower bound on any enclosing sphere's radius, from the dual (Yildirim 2008): with weights u on the
// points, sum u |p|^2 - |sum u p|^2 never exceeds the smallest squared radius. Frank-Wolfe with exact line
// search.
double least_radius(const Points& points) {
  std::vector<double> weight(points.size(), 0.0);
  weight[0] = 1;
  Vector3d centre = points[0];
  double best = 0;
  for (int i = 0; i < 20000; ++i) {
    std::size_t farthest = 0;
    for (std::size_t k = 0; k < points.size(); ++k) {
      if ((points[k] - centre).squaredNorm() > (points[farthest] - centre).squaredNorm()) farthest = k;
    }
    double dual = 0;
    for (std::size_t k = 0; k < points.size(); ++k) dual += weight[k] * (points[k] - centre).squaredNorm();
    best = std::max(best, dual);
    const double far = (points[farthest] - centre).squaredNorm();
    if (far <= dual * (1 + 1e-9)) break;
    const double step = 0.5 * (1 - dual / far);
    for (double& w : weight) w *= 1 - step;
    weight[farthest] += step;
    centre = (1 - step) * centre + step * points[farthest];
  }
  return std::sqrt(best);
}

void expect_smallest(const Points& points, double tolerance) {
  const Sphere sphere = smallest_sphere(points);
  for (const Vector3d& p : points) {
    ASSERT_LE((p - sphere.centre).norm(), sphere.radius * (1 + 1e-12) + 1e-15);
  }
  EXPECT_LE(sphere.radius, least_radius(points) * (1 + tolerance) + 1e-15);
}

TEST(BoundingSphere, KnownSpheres) {
  EXPECT_EQ(smallest_sphere({}).radius, 0);
  EXPECT_EQ(smallest_sphere({{1, 2, 3}}).centre, Vector3d(1, 2, 3));
  const Sphere two = smallest_sphere({{1, 0, 0}, {3, 0, 0}});
  EXPECT_NEAR(two.radius, 1, 1e-12);
  EXPECT_TRUE(two.centre.isApprox(Vector3d(2, 0, 0)));
  // An obtuse triangle: its longest side is the diameter.
  EXPECT_NEAR(smallest_sphere({{0, 0, 0}, {4, 0, 0}, {2, 0.5, 0}}).radius, 2, 1e-12);
  Points cube;
  for (int i = 0; i < 8; ++i) cube.emplace_back(i & 1, i >> 1 & 1, i >> 2);
  const Sphere around = smallest_sphere(cube);
  EXPECT_NEAR(around.radius, std::sqrt(3) / 2, 1e-12);
  EXPECT_TRUE(around.centre.isApprox(Vector3d(0.5, 0.5, 0.5), 1e-12));
}

TEST(BoundingSphere, RandomCloudsMatchTheDualBound) {
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 60; ++i) {
    Points points;
    const int n = 1 + static_cast<int>(random() % 60);
    const Vector3d stretch(1, i % 3 == 0 ? 1e-3 : 1, i % 5 == 0 ? 1e-4 : 1);
    for (int k = 0; k < n; ++k) {
      points.emplace_back(stretch.cwiseProduct(Vector3d(normal(random), normal(random), normal(random))));
    }
    expect_smallest(points, 1e-4);
  }
}

// Many points on one sphere or on two circles, with the rounding of floats: where naive Welzl jumps about.
TEST(BoundingSphere, ManyPointsOnTheSurface) {
  std::mt19937_64 random(12);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 20; ++i) {
    Points points;
    const Vector3d shift(normal(random), normal(random), normal(random));
    for (int k = 0; k < 500; ++k) {
      const Vector3d d = Vector3d(normal(random), normal(random), normal(random)).normalized();
      points.emplace_back((d + shift).cast<float>().cast<double>());
    }
    const Sphere sphere = smallest_sphere(points);
    EXPECT_NEAR(sphere.radius, 1, 1e-3);
    expect_smallest(points, 1e-4);
  }
  for (const double height : {1e-6, 0.01, 1.0, 7.0}) {
    for (const int sides : {3, 4, 31, 64, 1000}) {
      Points points;
      for (int k = 0; k < sides; ++k) {
        const double turn = 2 * std::numbers::pi * k / sides;
        for (const double z : {-height / 2, height / 2}) {
          points.emplace_back(
              Vector3d(0.033 * std::cos(turn), 0.033 * std::sin(turn), 0.1 * z).cast<float>().cast<double>());
        }
      }
      const Sphere sphere = smallest_sphere(points);
      const double wanted = std::hypot(0.033, 0.05 * height);
      EXPECT_NEAR(sphere.radius, wanted, 2e-7 * wanted) << height << " " << sides;
      EXPECT_LT(sphere.centre.norm(), 1e-6) << height << " " << sides;
    }
  }
}

TEST(BoundingSphere, FarFromTheOrigin) {
  const Vector3d shift(1e6, -2e6, 3e6);
  const Sphere sphere =
      smallest_sphere({Vector3d(-1, 0, 0) + shift, Vector3d(1, 0, 0) + shift, Vector3d(0, 0.5, 0.5) + shift});
  EXPECT_NEAR(sphere.radius, 1, 1e-8);
  EXPECT_LT((sphere.centre - shift).norm(), 1e-8);
}

TEST(BoundingSphere, MovesWithTheObject) {
  std::mt19937_64 random(13);
  std::normal_distribution<double> normal;
  Points points;
  for (int k = 0; k < 200; ++k) points.emplace_back(normal(random), 2 * normal(random), normal(random));
  const Sphere before = smallest_sphere(points);
  const Eigen::Matrix3d turn = Eigen::Quaterniond(0.3, 0.5, -0.2, 0.7).normalized().toRotationMatrix();
  Points turned;
  for (const Vector3d& p : points) turned.emplace_back(turn * p + Vector3d(5, 6, 7));
  const Sphere after = smallest_sphere(turned);
  EXPECT_NEAR(after.radius, before.radius, 1e-9);
  EXPECT_LT((after.centre - turn * before.centre - Vector3d(5, 6, 7)).norm(), 1e-7);
}

}  // namespace
}  // namespace sextant
