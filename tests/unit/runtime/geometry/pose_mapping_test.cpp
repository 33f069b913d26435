// SPDX-License-Identifier: Apache-2.0
#include "runtime/geometry/pose_mapping.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace sextant {
namespace {

constexpr double kPi = std::numbers::pi;
const PinholeCamera kCamera{640, 480, 525, 319.5, 239.5};

TEST(PoseMapping, RoundTripsToOneNanoUnit) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int i = 0; i < 20000; ++i) {
    const Pose6 pose{unit(random) * 640,
                     unit(random) * 480,
                     0.3 + 3 * unit(random),
                     (2 * unit(random) - 1) * 3.14,
                     -(0.001 + unit(random) * 1.56),
                     (2 * unit(random) - 1) * 3.14};
    const Pose6 back = pose_from_transform(kCamera, transform_from_pose(kCamera, pose));
    EXPECT_NEAR(back.x, pose.x, 1e-9);
    EXPECT_NEAR(back.y, pose.y, 1e-9);
    EXPECT_NEAR(back.z, pose.z, 1e-9);
    EXPECT_NEAR(back.rx, pose.rx, 1e-9);
    EXPECT_NEAR(back.ry, pose.ry, 1e-9);
    EXPECT_NEAR(back.rz, pose.rz, 1e-9);
  }
}

TEST(PoseMapping, IsAProperRotation) {
  const Eigen::Matrix3d r = transform_from_pose(kCamera, {100, 50, 1, 0.3, -0.7, 2}).linear();
  EXPECT_NEAR((r * r.transpose() - Eigen::Matrix3d::Identity()).norm(), 0, 1e-12);
  EXPECT_NEAR(r.determinant(), 1, 1e-12);
}

TEST(PoseMapping, LevelViewAtTheCentreLooksAtTheFront) {
  const RigidTransform t = transform_from_pose(kCamera, {319.5, 239.5, 2, 0, 0, 0});
  EXPECT_TRUE(t.translation().isApprox(Eigen::Vector3d(0, 0, 2)));
  EXPECT_TRUE(t.linear().col(2).isApprox(Eigen::Vector3d(0, -1, 0)));  // up is -y
  EXPECT_TRUE(t.linear().col(0).isApprox(Eigen::Vector3d(1, 0, 0)));
}

TEST(PoseMapping, SeenFromAboveTheObjectsTopTiltsTowardsTheCamera) {
  const RigidTransform t = transform_from_pose(kCamera, {319.5, 239.5, 2, 0, -kPi / 4, 0});
  EXPECT_LT(t.linear().col(2).z(), -0.7);
}

TEST(PoseMapping, PositiveRxTurnsTheObjectsTopToTheRight) {
  const RigidTransform t = transform_from_pose(kCamera, {319.5, 239.5, 2, 0.1, 0, 0});
  EXPECT_GT(t.linear()(0, 2), 0.09);
}

TEST(PoseMapping, StraightFromAboveKeepsTheTransform) {
  const RigidTransform t = transform_from_pose(kCamera, {200, 100, 1, 0, -kPi / 2, 1.0});
  const RigidTransform again = transform_from_pose(kCamera, pose_from_transform(kCamera, t));
  EXPECT_LT(rotation_angle_between(t, again), 1e-7);
}

TEST(RotationAngle, MeasuresWhatWasTurned) {
  RigidTransform a = RigidTransform::Identity();
  RigidTransform b = a;
  b.rotate(Eigen::AngleAxisd(0.25, Eigen::Vector3d(1, 2, 3).normalized()));
  EXPECT_NEAR(rotation_angle_between(a, b), 0.25, 1e-12);
}

}  // namespace
}  // namespace sextant
