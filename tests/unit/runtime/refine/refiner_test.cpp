// SPDX-License-Identifier: Apache-2.0
#include "runtime/refine/refiner.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "tests/unit/runtime/refine/refine_scene.h"

namespace sextant {
namespace {

using namespace test;

const TableGeometry kTable = TableGeometry::from_pitch_roll(40 * kDegree, 1 * kDegree, 0.6);

ObjectModel box() { return model_of(box_mesh({0.08F, 0.035F, 0.1F}), 0.1, 180); }

RefineFrame seen(const Scene& scene, bool with_table = true) {
  return {scene.frame, scene.edges, with_table ? std::optional(kTable) : std::nullopt, TableTolerance{}};
}

double shift_mm(const RigidTransform& a, const RigidTransform& b) {
  return 1e3 * (a.translation() - b.translation()).norm();
}

double turn_deg(const RigidTransform& a, const RigidTransform& b) {
  return rotation_angle_between(a, b) / kDegree;
}

TEST(Refiner, FindsTheExactPoseWithoutNoise) {
  const ObjectModel model = box();
  Refiner refiner(model);
  Random random(3);
  for (int i = 0; i < 10; ++i) {
    const RigidTransform truth =
        standing(model, kTable, random.uniform(200, 440), random.uniform(180, 300), random.uniform(0, 6.28));
    const Scene scene = make_scene({{&model.mesh, truth}}, kTable, "none", 0);
    const RigidTransform start = moved(truth, random, 0.006, 0.002, 2);
    const RefinedPose refined = refiner.refine(seen(scene), start);
    EXPECT_TRUE(refined.quality.refined);
    EXPECT_LT(shift_mm(refined.camera_from_object, truth), 1.0) << i;
    EXPECT_LT(turn_deg(refined.camera_from_object, truth), 0.5) << i;
    EXPECT_GT(refined.quality.depth_inlier_share, 0.95);
    // Between faces of nearly the same grey there is no edge to find.
    EXPECT_GT(refined.quality.edge_inlier_share, 0.6);
  }
}

TEST(Refiner, IsDeterministic) {
  const ObjectModel model = box();
  const RigidTransform truth = standing(model, kTable, 300, 240, 0.5);
  const Scene scene = make_scene({{&model.mesh, truth}}, kTable, "kinect1", 4);
  Random random(1);
  const RigidTransform start = moved(truth, random, 0.006, 0.002, 2);
  Refiner once(model);
  Refiner again(model);
  again.refine(seen(scene), truth);  // what it did before must not matter
  const RefinedPose a = once.refine(seen(scene), start);
  const RefinedPose b = again.refine(seen(scene), start);
  EXPECT_EQ(a.camera_from_object.matrix(), b.camera_from_object.matrix());
  EXPECT_EQ(a.covariance, b.covariance);
}

// The covariance is honest when the squared error in its units (NEES) is 6 on average. Sensor, warp, shift
// between colour and depth come from the synthesiser's model of a Kinect.
TEST(Refiner, CovarianceIsConsistentWithTheErrors) {
  const ObjectModel model = box();
  Refiner refiner(model);
  Random random(11);
  double sum = 0;
  std::vector<double> errors_mm;
  constexpr int kTrials = 60;
  int within95 = 0;
  for (int i = 0; i < kTrials; ++i) {
    const RigidTransform truth =
        standing(model, kTable, random.uniform(200, 440), random.uniform(160, 320), random.uniform(0, 6.28));
    const Scene scene = make_scene({{&model.mesh, truth}}, kTable, "kinect1", 100 + random.bits() % 1000);
    const RefinedPose refined = refiner.refine(seen(scene), moved(truth, random, 0.005, 0.0015, 1.5));
    const RigidTransform& estimate = refined.camera_from_object;
    const Eigen::AngleAxisd turn(Eigen::Matrix3d(truth.linear() * estimate.linear().transpose()));
    Eigen::Matrix<double, 6, 1> error;
    error << truth.translation() - estimate.translation(), turn.angle() * turn.axis();
    const double nees = error.dot(refined.covariance.inverse() * error);
    sum += nees;
    within95 += nees < 12.59 ? 1 : 0;  // chi square, 6 degrees of freedom
    errors_mm.push_back(shift_mm(estimate, truth));
  }
  std::sort(errors_mm.begin(), errors_mm.end());
  const double mean = sum / kTrials;
  std::printf("NEES mean %.2f of 6, below 12.59: %d of %d, median error %.2f mm\n", mean, within95, kTrials,
              errors_mm[kTrials / 2]);
  EXPECT_GT(mean, 1.2) << "far too cautious";
  EXPECT_LT(mean, 9.0) << "too sure of itself";
  EXPECT_GE(within95, kTrials * 85 / 100);
  EXPECT_LT(errors_mm[kTrials / 2], 2.5);
}

TEST(Refiner, WhatStandsInFrontIsNoMisfit) {
  const ObjectModel model = box();
  const ModelMesh pole = box_mesh({0.02F, 0.02F, 0.12F});
  const ObjectModel pole_model = model_of(pole, 0.12, 90);
  const RigidTransform truth = standing(model, kTable, 320, 240, 0.4);
  RigidTransform before = standing(pole_model, kTable, 330, 290, 0.1);
  before.translation() *= 0.8;
  const Scene scene = make_scene({{&model.mesh, truth}, {&pole, before}}, kTable, "kinect1", 8);
  Random random(5);
  Refiner refiner(model);
  const RefinedPose refined = refiner.refine(seen(scene), moved(truth, random, 0.005, 0.0015, 1.5));
  EXPECT_GT(refined.quality.occluded_share, 0.1);
  EXPECT_LT(shift_mm(refined.camera_from_object, truth), 5);
  EXPECT_LT(turn_deg(refined.camera_from_object, truth), 3);
}

TEST(Refiner, WithoutDepthTheEdgesDecideAndTheCovarianceKnows) {
  const ObjectModel model = box();
  const RigidTransform truth = standing(model, kTable, 320, 240, 0.6);
  Scene scene = make_scene({{&model.mesh, truth}}, kTable, "none", 0);
  Refiner refiner(model);
  const RefinedPose with = refiner.refine(seen(scene), truth);
  scene.frame.ray_depth_m.setTo(0);
  Random random(6);
  const RefinedPose without = refiner.refine(seen(scene, false), moved(truth, random, 0.004, 0.001, 1));
  EXPECT_DOUBLE_EQ(without.quality.missing_share, 1);
  EXPECT_LT(turn_deg(without.camera_from_object, truth), 2);
  EXPECT_LT(shift_mm(without.camera_from_object, truth), 8);
  EXPECT_GT(without.covariance.trace(), with.covariance.trace());
}

TEST(Refiner, ARoundObjectDoesNotSpinAndSaysSo) {
  const ObjectModel model = model_of(cylinder_mesh(0.035F, 0.06F), 0.06, 0);
  const RigidTransform truth = standing(model, kTable, 320, 240, 0);
  const Scene scene = make_scene({{&model.mesh, truth}}, kTable, "kinect1", 9);
  Random random(2);
  Refiner refiner(model);
  const RigidTransform start = moved(truth, random, 0.006, 0.002, 2);
  const RefinedPose refined = refiner.refine(seen(scene), start);
  EXPECT_LT(shift_mm(refined.camera_from_object, truth), 4);
  const Eigen::Vector3d axis = refined.camera_from_object.linear().col(2);
  EXPECT_LT(std::acos(std::min(1.0, axis.dot(truth.linear().col(2)))) / kDegree, 2);
  // The turn from start to result has no part along the axis.
  const Eigen::AngleAxisd turn(
      Eigen::Matrix3d(refined.camera_from_object.linear() * start.linear().transpose()));
  EXPECT_LT(std::abs(turn.angle() * turn.axis().dot(axis)) / kDegree, 0.3);
  const double spin = axis.dot(refined.covariance.bottomRightCorner<3, 3>() * axis);
  EXPECT_NEAR(spin, std::numbers::pi * std::numbers::pi / 3, 1e-6);
  // Only that: across the axis it is known well.
  const Eigen::Vector3d across = axis.unitOrthogonal();
  EXPECT_LT(std::sqrt(across.dot(refined.covariance.bottomRightCorner<3, 3>() * across)) / kDegree, 3);
}

TEST(Refiner, AnOptimumFarFromTheLatticePoseIsRefusedAndSaid) {
  const ObjectModel model = box();
  const RigidTransform truth = standing(model, kTable, 320, 240, 0.4);
  // The table is stated where it is not: contact pulls the pose out of its neighbourhood.
  const Scene scene = make_scene({{&model.mesh, truth}}, kTable, "none", 0);
  Scene blind = scene;
  blind.frame.ray_depth_m.setTo(0);
  blind.edges.setTo(0);
  TableGeometry wrong = kTable;
  wrong.camera_height_m += 0.2;
  TableTolerance tight;
  tight.height_m = 0.001;
  Refiner refiner(model);
  const RefinedPose refined = refiner.refine({blind.frame, blind.edges, wrong, tight}, truth);
  EXPECT_TRUE(refined.quality.left_neighbourhood);
  EXPECT_FALSE(refined.quality.refined);
  EXPECT_EQ(refined.camera_from_object.matrix(), truth.matrix());
  EXPECT_GT(refined.quality.shift_m, Refiner::kMaxShiftM);
  EXPECT_GT(std::sqrt(refined.covariance(0, 0)), 0.01) << "nobody knows where it is";
}

TEST(Refiner, SurvivesPosesOutsideTheImageAndModelsWithoutMesh) {
  ObjectModel model = box();
  const RigidTransform truth = standing(model, kTable, 320, 240, 0.4);
  const Scene scene = make_scene({{&model.mesh, truth}}, kTable, "none", 0);
  Refiner refiner(model);
  RigidTransform outside = truth;
  outside.translation() = Eigen::Vector3d(5, 0, 1);
  const RefinedPose lost = refiner.refine(seen(scene, false), outside);
  EXPECT_EQ(lost.quality.depth_samples, 0);
  EXPECT_TRUE(lost.covariance.allFinite());
  RigidTransform behind = truth;
  behind.translation() = Eigen::Vector3d(0, 0, -1);
  EXPECT_TRUE(refiner.refine(seen(scene, false), behind).camera_from_object.matrix().allFinite());
  model.mesh = {};
  Refiner bare(model);
  EXPECT_FALSE(bare.refine(seen(scene), truth).quality.refined);
}

TEST(WithModelError, OnlyAddsAndStaysHonestAboutTheSpin) {
  const ObjectModel model = model_of(cylinder_mesh(0.035F, 0.06F), 0.06, 0);
  const RigidTransform truth = standing(model, kTable, 320, 240, 0);
  const Scene scene = make_scene({{&model.mesh, truth}}, kTable, "kinect1", 9);
  Refiner refiner(model);
  const auto sensor = refiner.refine(seen(scene), truth).covariance;
  const auto published = with_model_error(sensor);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> added(published - sensor);
  EXPECT_GT(added.eigenvalues().minCoeff(), 1e-7);
  EXPECT_GT(std::sqrt(published(2, 2)), 0.001);
  EXPECT_LT(std::sqrt(published(2, 2)), 0.006);
}

TEST(MovedCovariance, IsThatOfTheMovedPoint) {
  Eigen::Matrix<double, 6, 6> root = Eigen::Matrix<double, 6, 6>::Identity() * 1e-3;
  root(0, 4) = 5e-4;
  root(3, 3) = 2e-3;
  const Eigen::Matrix<double, 6, 6> covariance = root * root.transpose();
  const Eigen::Vector3d offset(0.1, -0.2, 0.05);
  // By samples: position + turn x offset.
  Random random(8);
  Eigen::Matrix<double, 6, 6> sampled = Eigen::Matrix<double, 6, 6>::Zero();
  constexpr int kSamples = 20000;
  for (int i = 0; i < kSamples; ++i) {
    Eigen::Matrix<double, 6, 1> unit;
    for (int k = 0; k < 6; ++k) unit[k] = random.normal();
    Eigen::Matrix<double, 6, 1> e = root * unit;
    e.head<3>() += e.tail<3>().cross(offset);
    sampled += e * e.transpose() / kSamples;
  }
  const Eigen::Matrix<double, 6, 6> moved = moved_covariance(covariance, offset);
  EXPECT_LT((moved - sampled).norm(), 0.05 * moved.norm());
}

}  // namespace
}  // namespace sextant
