// SPDX-License-Identifier: Apache-2.0
// MSSD, MSPD and VSD of cases small enough to work out by hand.
#include "offline/evaluate/bop_error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace sextant {
namespace {

const Eigen::Vector3d kCentre(0.01, 0, 0.05);

std::vector<Eigen::Vector3d> box_corners() {
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 8; ++i)
    points.push_back(kCentre +
                     Eigen::Vector3d(i & 1 ? 0.04 : -0.04, i & 2 ? 0.02 : -0.02, i & 4 ? 0.05 : -0.05));
  return points;
}

RigidTransform at(double x, double y, double z) { return RigidTransform(Eigen::Translation3d(x, y, z)); }

std::vector<RigidTransform> symmetries(int degrees) {
  return symmetry_transforms(SymmetryGroup::about(Eigen::Vector3d::UnitZ(), degrees), kCentre);
}

TEST(SymmetryTransforms, KeepTheCentreAndCountTheSteps) {
  EXPECT_EQ(1U, symmetries(360).size());
  EXPECT_EQ(2U, symmetries(180).size());
  EXPECT_EQ(4U, symmetries(90).size());
  EXPECT_EQ(315U, symmetries(0).size());
  for (const RigidTransform& t : symmetries(90)) EXPECT_TRUE((t * kCentre).isApprox(kCentre, 1e-12));
}

TEST(Mssd, ShiftIsItself) {
  EXPECT_NEAR(0.005, mssd_m(box_corners(), at(0.003, 0.004, 1), at(0, 0, 1), symmetries(360)), 1e-12);
}

TEST(Mssd, HalfATurnAboutTheCentreIsTheWidestCornerUnlessItIsASymmetry) {
  const RigidTransform turned = at(0, 0, 1) * symmetries(180)[1];
  // A corner (0.04, 0.02) goes to (-0.04, -0.02).
  EXPECT_NEAR(2 * std::hypot(0.04, 0.02), mssd_m(box_corners(), turned, at(0, 0, 1), symmetries(360)), 1e-12);
  EXPECT_NEAR(0, mssd_m(box_corners(), turned, at(0, 0, 1), symmetries(180)), 1e-12);
}

TEST(Mssd, TurnsOfARotationalSymmetryCostAtMostHalfAStep) {
  const RigidTransform turned = at(0, 0, 1) * symmetries(0)[100];
  EXPECT_NEAR(0, mssd_m(box_corners(), turned, at(0, 0, 1), symmetries(0)), 1e-9);
  RigidTransform between = at(0, 0, 1) * Eigen::Translation3d(kCentre) *
                           Eigen::AngleAxisd(0.5 * 2 * std::numbers::pi / 315, Eigen::Vector3d::UnitZ()) *
                           Eigen::Translation3d(-kCentre);
  const double half_step = 2 * std::hypot(0.04, 0.02) * std::sin(0.25 * 2 * std::numbers::pi / 315);
  EXPECT_NEAR(half_step, mssd_m(box_corners(), between, at(0, 0, 1), symmetries(0)), 1e-9);
}

TEST(Mspd, ShiftAcrossIsFocalLengthTimesShiftOverDepth) {
  CameraModel camera;
  camera.fx = camera.fy = 500;
  camera.cx = 320;
  camera.cy = 240;
  const std::vector<Eigen::Vector3d> flat{{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}};
  const auto none = symmetry_transforms({}, Eigen::Vector3d::Zero());
  EXPECT_NEAR(500 * 0.01 / 0.8, mspd_px(flat, camera, at(0.01, 0, 0.8), at(0, 0, 0.8), none), 1e-9);
  // Along the axis: the farthest point from the centre moves most, 500 * 0.1 * (1/0.8 - 1/1.0).
  EXPECT_NEAR(500 * 0.1 * (1 / 0.8 - 1), mspd_px(flat, camera, at(0, 0, 1), at(0, 0, 0.8), none), 1e-9);
  EXPECT_TRUE(std::isinf(mspd_px(flat, camera, at(0, 0, -1), at(0, 0, 0.8), none)));
}

/// 10 x 10 pixels: the object covers columns [from, to) at a distance.
cv::Mat strip(int from, int to, float distance, float elsewhere = 0) {
  cv::Mat image(10, 10, CV_32FC1, cv::Scalar(elsewhere));
  image(cv::Rect(from, 0, to - from, 10)).setTo(distance);
  return image;
}

TEST(Vsd, IsZeroForTheSamePoseAndOneForAMiss) {
  const cv::Mat measured = strip(2, 6, 0.8F, 1.2F);
  for (const double e : vsd(strip(2, 6, 0.8F), strip(2, 6, 0.8F), measured, 0.2)) EXPECT_EQ(0, e);
  // Ten pixels wide apart: nothing in common. The estimate lies in front of the measured table: seen.
  for (const double e : vsd(strip(6, 10, 0.8F), strip(2, 6, 0.8F), measured, 0.2)) EXPECT_EQ(1, e);
}

TEST(Vsd, CountsPixelsOutsideOfTheOtherOne) {
  // Three of four columns overlap: union 5 columns, 2 of them in one only.
  const cv::Mat measured = strip(2, 6, 0.8F, 1.2F);
  for (const double e : vsd(strip(3, 7, 0.8F), strip(2, 6, 0.8F), measured, 0.2)) EXPECT_NEAR(0.4, e, 1e-12);
}

TEST(Vsd, DepthCountsAgainstEachTolerance) {
  // 13 mm of 200 mm: 6.5 % of the diameter: beyond 5 %, within 10 %.
  const cv::Mat measured = strip(2, 6, 0.8F, 1.2F);
  const std::vector<double> e = vsd(strip(2, 6, 0.813F), strip(2, 6, 0.8F), measured, 0.2);
  EXPECT_EQ(1, e[0]);
  for (std::size_t i = 1; i < e.size(); ++i) EXPECT_EQ(0, e[i]);
}

TEST(Vsd, WhatIsHiddenDoesNotCountAndMissingDepthHidesNothing) {
  // An occluder at 0.5 m covers columns 4..9: of the truth columns 2 and 3 are seen.
  const cv::Mat occluded = strip(4, 10, 0.5F, 0.8F);
  for (const double e : vsd(strip(2, 4, 0.8F), strip(2, 6, 0.8F), occluded, 0.2)) EXPECT_EQ(0, e);
  const cv::Mat missing(10, 10, CV_32FC1, cv::Scalar(0));
  for (const double e : vsd(strip(2, 4, 0.8F), strip(2, 6, 0.8F), missing, 0.2)) EXPECT_NEAR(0.5, e, 1e-12);
}

TEST(Vsd, AnEstimateBehindTheTrueObjectIsStillCompared) {
  // 40 mm behind the measured surface: hidden by it, but the surface is the true object's.
  const cv::Mat measured = strip(2, 6, 0.8F, 1.2F);
  const std::vector<double> e = vsd(strip(2, 6, 0.84F), strip(2, 6, 0.8F), measured, 0.2);
  for (std::size_t i = 0; i < e.size(); ++i)
    EXPECT_EQ(bop_share(static_cast<int>(i)) <= 0.199 ? 1 : 0, e[i]) << i;
}

}  // namespace
}  // namespace sextant
