// SPDX-License-Identifier: Apache-2.0
// The measures themselves, against definitions spelled out by brute force.
#include <gtest/gtest.h>

#include <numbers>

#include "offline/evaluate/average_precision.h"
#include "offline/evaluate/point_error.h"
#include "offline/evaluate/symmetry_group.h"
#include "tests/support/random_pose.h"

namespace sextant {
namespace {

constexpr double kPi = std::numbers::pi;

Eigen::Matrix3d turn(const Eigen::Vector3d& axis, double angle) {
  return Eigen::AngleAxisd(angle, axis).matrix();
}

TEST(RotationError, WithoutSymmetryIsTheAngleBetween) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> angle(0, kPi);
  for (int i = 0; i < 500; ++i) {
    const Eigen::Matrix3d truth = random_rotation(random);
    const double a = i == 0 ? 0.0 : (i == 1 ? 1e-9 : (i == 2 ? kPi : angle(random)));
    const Eigen::Vector3d axis = random_rotation(random).col(0);
    EXPECT_NEAR(a, rotation_error_rad(truth * turn(axis, a), truth, {}), 1e-7);
  }
}

TEST(RotationError, OfAnAxialSymmetryIsTheSmallestOverAllTurns) {
  std::mt19937_64 random(2);
  for (int i = 0; i < 50; ++i) {
    const Eigen::Matrix3d truth = random_rotation(random);
    const Eigen::Matrix3d estimate = random_rotation(random);
    const Eigen::Vector3d axis = random_rotation(random).col(0);
    double brute = kPi;
    constexpr int kSteps = 7200;
    for (int k = 0; k < kSteps; ++k) {
      brute = std::min(brute, rotation_error_rad(estimate, truth * turn(axis, 2 * kPi * k / kSteps), {}));
    }
    EXPECT_NEAR(brute, rotation_error_rad(estimate, truth, SymmetryGroup::about(axis, 0)), 1e-3);
  }
}

TEST(RotationError, DoesNotSeeTurnsOfTheGroupAndSeesAllOthers) {
  std::mt19937_64 random(3);
  const Eigen::Vector3d up = random_rotation(random).col(1);
  for (const int degrees : {90, 180, 360}) {
    const SymmetryGroup group = SymmetryGroup::about(up, degrees);
    EXPECT_EQ(static_cast<std::size_t>(360 / degrees), group.rotations.size());
    for (int yaw = 0; yaw < 360; yaw += 30) {
      const Eigen::Matrix3d truth = random_rotation(random);
      const int left = yaw % degrees;
      const double expected = std::min(left, degrees - left) * kPi / 180;
      EXPECT_NEAR(expected, rotation_error_rad(truth * turn(up, yaw * kPi / 180), truth, group), 1e-9)
          << degrees << yaw;
    }
  }
}

TEST(RotationError, UsesOurKeyFirstAndTheShapeAloneWhenAsked) {
  ModelInfo info;
  info.up = Eigen::Vector3d::UnitY();
  info.symmetry_deg = 360;
  info.geometric_symmetry_deg = 0;
  EXPECT_EQ(1U, symmetry_group_of(info, false).rotations.size());
  ASSERT_EQ(1U, symmetry_group_of(info, true).axes.size());
  EXPECT_EQ(Eigen::Vector3d::UnitY(), symmetry_group_of(info, true).axes[0]);
  ModelInfo bop;
  bop.discrete.emplace_back(Eigen::AngleAxisd(kPi, Eigen::Vector3d::UnitX()));
  bop.continuous.push_back({Eigen::Vector3d::UnitZ(), Eigen::Vector3d::Zero()});
  const SymmetryGroup group = symmetry_group_of(bop, false);
  EXPECT_EQ(2U, group.rotations.size());
  // A flipped cylinder turned at will is the same cylinder.
  const Eigen::Matrix3d flipped = turn(Eigen::Vector3d::UnitX(), kPi) * turn(Eigen::Vector3d::UnitZ(), 1.234);
  EXPECT_NEAR(0, rotation_error_rad(flipped, Eigen::Matrix3d::Identity(), group), 1e-7);
}

TEST(PointError, OfAShiftIsItsLengthAndSymmetryHelpsOnlyAddS) {
  std::mt19937_64 random(4);
  const RigidTransform truth = random_pose(random);
  std::vector<Eigen::Vector3d> ring;
  for (int i = 0; i < 360; ++i)
    ring.emplace_back(0.05 * std::cos(i * kPi / 180), 0.05 * std::sin(i * kPi / 180), 0.1);
  RigidTransform shifted = truth;
  shifted.pretranslate(Eigen::Vector3d(0, 0.003, 0.004));
  EXPECT_NEAR(0.005, add_m(ring, shifted, truth), 1e-12);
  EXPECT_LE(add_s_m(ring, shifted, truth), 0.005);
  const RigidTransform turned = truth * Eigen::AngleAxisd(kPi / 2, Eigen::Vector3d::UnitZ());
  EXPECT_NEAR(0.05 * std::sqrt(2.0), add_m(ring, turned, truth), 1e-9);
  EXPECT_NEAR(0, add_s_m(ring, turned, truth), 1e-9);
}

TEST(PointError, ThinningKeepsTheEndsApart) {
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 1000; ++i) points.emplace_back(static_cast<float>(i), 0, 0);
  const auto kept = thinned(points, 10);
  ASSERT_EQ(10U, kept.size());
  EXPECT_EQ(900, kept.back().x());
  EXPECT_EQ(1000U, thinned(points, 5000).size());
}

TEST(AveragePrecision, OfHandMadeLists) {
  EXPECT_EQ(1, average_precision({{0.9, true}, {0.8, true}}, 2));
  EXPECT_EQ(0.5, average_precision({{0.9, true}}, 2));
  EXPECT_EQ(0, average_precision({{0.9, false}}, 2));
  EXPECT_EQ(0, average_precision({}, 3));
  EXPECT_EQ(0, average_precision({{0.9, false}}, 0));
  // hit, miss, hit of two: precision 1 up to recall 1/2, then 2/3.
  EXPECT_NEAR(0.5 * 1 + 0.5 * 2 / 3, average_precision({{0.9, true}, {0.8, false}, {0.7, true}}, 2), 1e-12);
  // The order comes from the scores; a miss goes first in a tie.
  EXPECT_NEAR(0.5, average_precision({{0.5, true}, {0.5, false}}, 1), 1e-12);
  // Interpolation: a late better precision counts for earlier recalls: miss, hit, hit of two.
  EXPECT_NEAR(2.0 / 3, average_precision({{0.9, false}, {0.8, true}, {0.7, true}}, 2), 1e-12);
}

}  // namespace
}  // namespace sextant
