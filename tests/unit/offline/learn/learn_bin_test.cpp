// SPDX-License-Identifier: Apache-2.0
// Learning against views whose answer is known: a feature that moves linearly with the rotation, a plane of
// known slope.
#include "offline/learn/learn_bin.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "offline/learn/bin_codec.h"
#include "runtime/search/lattice.h"

namespace sextant {
namespace {

constexpr double kRadius = 0.1;

/// Views with one vertical edge pixel at offset 0.02 + 0.1 rx - 0.05 rz (tangent * metre), 0.01 up, and a
/// depth of z - 0.03 + 0.04 ry on the left half of the object.
std::vector<TrainingView> known_views(const LearnParameters& p, const RotationBox& box) {
  std::mt19937 random(8);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<TrainingView> views;
  for (int i = 0; i < p.images_per_bin; ++i) {
    TrainingView v;
    const auto angle = [&](std::size_t a) {
      return (box.lo_deg[a] + (box.hi_deg[a] - box.lo_deg[a]) * unit(random)) * kOneDegree;
    };
    v.pose = {300 + 20 * unit(random),
              200 + 20 * unit(random),
              0.5 + 0.3 * unit(random),
              angle(0),
              angle(1),
              angle(2)};
    const double scale = p.camera.focal / v.pose.z;
    const int half = static_cast<int>(scale * kRadius) + 8;
    v.window = {static_cast<int>(v.pose.x) - half, static_cast<int>(v.pose.y) - half, 2 * half, 2 * half};
    v.edges = cv::Mat::zeros(v.window.size(), CV_8UC1);
    const double u = 0.02 + 0.1 * v.pose.rx - 0.05 * v.pose.rz;
    const auto column = static_cast<int>(std::lround(v.pose.x + scale * u)) - v.window.x;
    const auto row = static_cast<int>(std::lround(v.pose.y - scale * 0.01)) - v.window.y;
    v.edges.at<std::uint8_t>(row, column) = 1U << 4;
    v.ray_depth_m = cv::Mat::zeros(v.window.size(), CV_32FC1);
    const int middle = static_cast<int>(std::lround(v.pose.x)) - v.window.x;
    v.ray_depth_m.colRange(0, middle).setTo(v.pose.z - 0.03 + 0.04 * v.pose.ry);
    views.push_back(v);
  }
  return views;
}

TEST(LearnBin, RecoversKnownParts) {
  LearnParameters p;
  p.depth_parts = 30;
  const RotationBox box{{-10, -50, 20}, {10, -30, 40}};
  const ViewpointBin bin = learn_bin(known_views(p, box), {}, p, box, kRadius);
  // One feature: all enumeration pixels share it, so there is one part.
  ASSERT_EQ(bin.visual.size(), 1U);
  const VisualPart& v = bin.visual[0];
  EXPECT_EQ(v.kind, 4);
  const double pixel = 0.8 / p.camera.focal;  // half a pixel of rounding at the farthest view, with margin
  EXPECT_NEAR(v.u[1], 0.1, pixel * 4);
  EXPECT_NEAR(v.u[2], 0, pixel * 4);
  EXPECT_NEAR(v.u[3], -0.05, pixel * 4);
  EXPECT_NEAR(v.u[0] + v.u[3] * 0.52, 0.02 - 0.05 * 0.52, pixel * 3);
  EXPECT_NEAR(v.v[0], -0.01, pixel * 3);
  EXPECT_LT(v.variance, 2 * pixel * pixel);

  EXPECT_EQ(bin.depth.size(), 30U);
  for (const DepthPart& d : bin.depth) {
    EXPECT_LT(d.px, 0);  // the right half has no depth in any view
    EXPECT_NEAR(d.d[2], 0.04, 1e-4);
    EXPECT_NEAR(d.d[1], 0, 1e-4);
    EXPECT_NEAR(d.d[0] + d.d[3] * 0.52, -0.03, 1e-4);
    EXPECT_LT(d.variance, 1e-8);
  }
}

/// The object covers u < 0; between 0 and 0.03 it is seen in two of three views; beyond that, the table.
TEST(LearnBin, TheRimAndTheTableBecomePartsToo) {
  LearnParameters p;
  p.images_per_bin = 30;
  p.depth_parts = 80;
  const RotationBox box{{-10, -50, 20}, {10, -30, 40}};
  auto views = known_views(p, box);
  for (std::size_t i = 0; i < views.size(); ++i) {
    TrainingView& v = views[i];
    const double scale = p.camera.focal / v.pose.z;
    const auto middle =
        static_cast<int>(std::lround(v.pose.x + (i % 3 == 0 ? 0 : 0.03) * scale)) - v.window.x;
    v.ray_depth_m.setTo(0);
    v.ray_depth_m.colRange(0, middle).setTo(v.pose.z - 0.03);
    v.table_depth_m = cv::Mat::zeros(v.window.size(), CV_32FC1);
    v.table_depth_m.colRange(middle, v.window.width).setTo(v.pose.z + 0.1 + 0.2 * v.pose.ry);
  }
  const ViewpointBin bin = learn_bin(views, {}, p, box, kRadius);
  ASSERT_EQ(bin.depth.size(), 80U);
  std::array<int, 3> count{};
  for (const DepthPart& d : bin.depth) {
    ++count[static_cast<std::size_t>(d.role)];
    if (d.role == DepthRole::kTable) {
      EXPECT_GT(d.px, 0.02);
      EXPECT_NEAR(d.d[2], 0.2, 1e-3);
    } else {
      EXPECT_LT(d.px, 0.035);
      EXPECT_NEAR(d.d[2], 0, 1e-3);
    }
    if (d.role == DepthRole::kRim) {
      EXPECT_GT(d.px, -0.005);
      EXPECT_LT(d.seen.found, 0.65);
    }
    EXPECT_LE(std::hypot(d.px, d.py), 1.01 * kRadius);
  }
  EXPECT_GT(count[0], 25);
  EXPECT_GT(count[1], 3);
  EXPECT_GT(count[2], 15);

  p.learn_table = 0;
  for (const DepthPart& d : learn_bin(views, {}, p, box, kRadius).depth) EXPECT_NE(d.role, DepthRole::kTable);
}

/// A table seen at a grazing angle: its depth runs away with the pitch.
TEST(LearnBin, WhatIsFarFromTheObjectIsNoPart) {
  LearnParameters p;
  p.depth_parts = 80;
  const RotationBox box{{-10, -10, 20}, {10, 10, 40}};
  const auto learnt = [&](double slope) {
    auto views = known_views(p, box);
    for (TrainingView& v : views) {
      v.table_depth_m = cv::Mat::zeros(v.window.size(), CV_32FC1);
      const int right = static_cast<int>(std::lround(v.pose.x)) - v.window.x + 2;
      v.table_depth_m.colRange(right, v.window.width).setTo(v.pose.z + 0.1 + slope * v.pose.ry);
    }
    int table = 0;
    for (const DepthPart& d : learn_bin(views, {}, p, box, kRadius).depth)
      table += d.role == DepthRole::kTable ? 1 : 0;
    return table;
  };
  EXPECT_GT(learnt(2), 10);  // 0.1 + 2 * 10 deg = 0.45 m
  EXPECT_EQ(learnt(3), 0);   // 0.62 m
  EXPECT_EQ(learnt(12), 0);
}

TEST(LearnBin, KindsThatAreOftenUnseenAreNoParts) {
  LearnParameters p;
  const RotationBox box{{-10, -50, 20}, {10, -30, 40}};
  auto views = known_views(p, box);
  views[5].edges.setTo(0);
  EXPECT_EQ(learn_bin(views, {}, p, box, kRadius).visual.size(), 1U);
  for (std::size_t i = 0; i < 10; ++i) views[i].edges.setTo(0);
  EXPECT_TRUE(learn_bin(views, {}, p, box, kRadius).visual.empty());
}

TEST(LearnBin, AnAngleOfOneDegreeGetsNoCoefficient) {
  LearnParameters p;
  const RotationBox box{{-10, -50, 0}, {10, -30, 1}};
  const ViewpointBin bin = learn_bin(known_views(p, box), {}, p, box, kRadius);
  ASSERT_FALSE(bin.visual.empty());
  for (const VisualPart& v : bin.visual) EXPECT_EQ(v.u[3], 0);
  for (const DepthPart& d : bin.depth) EXPECT_EQ(d.d[3], 0);
}

TEST(BinCodec, IsExactAndRefusesDamage) {
  LearnParameters p;
  const RotationBox box{{-10, -50, 20}, {10, -30, 40}};
  const ViewpointBin bin = learn_bin(known_views(p, box), {}, p, box, kRadius);
  auto bytes = encode_bin(bin);
  const ViewpointBin back = decode_bin(bytes);
  EXPECT_EQ(encode_bin(back), bytes);
  EXPECT_EQ(back.depth.size(), bin.depth.size());
  bytes.pop_back();
  EXPECT_THROW(decode_bin(bytes), std::runtime_error);
  bytes.resize(bytes.size() + 2);
  EXPECT_THROW(decode_bin(bytes), std::runtime_error);
  EXPECT_THROW(decode_bin({}), std::runtime_error);
}

}  // namespace
}  // namespace sextant
