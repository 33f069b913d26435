// SPDX-License-Identifier: Apache-2.0
#include "runtime/frame/table_estimate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace sextant {
namespace {

/// What a camera sees of a table with blocks on it, with noise and holes.
SearchFrame table_scene(const TableGeometry& table, unsigned seed, double table_share) {
  SearchFrame f;
  f.camera = {320, 240, 262, 159.5, 119.5};
  f.ray_depth_m = cv::Mat::zeros(240, 320, CV_32FC1);
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, 0.002);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 320; ++x) {
      const double sine = -table.up_in_camera.dot(f.camera.ray(x, y));
      if (sine < 0.05 || unit(random) < 0.05) continue;
      double d = table.camera_height_m / sine;
      const int column = x / 40;
      if (unit(random) > table_share || (column % 3 == 0 && y / 60 == 1)) d *= 0.75 + 0.2 * std::sin(0.1 * x);
      f.ray_depth_m.at<float>(y, x) = static_cast<float>(d + noise(random));
    }
  }
  return f;
}

TEST(TableEstimate, FindsTheTableUnderClutter) {
  for (unsigned seed = 0; seed < 12; ++seed) {
    const TableGeometry truth =
        TableGeometry::from_pitch_roll(0.4 + 0.05 * seed, 0.02 * (seed % 5) - 0.04, 0.6 + 0.05 * seed);
    const auto e = estimate_table(table_scene(truth, seed, 0.8));
    ASSERT_TRUE(e.has_value());
    EXPECT_NEAR(e->table.camera_height_m, truth.camera_height_m, 0.004);
    EXPECT_LT(std::acos(std::min(1.0, e->table.up_in_camera.dot(truth.up_in_camera))), 0.006);
    EXPECT_GT(e->inlier_share, 0.5);
  }
}

TEST(TableEstimate, RefusesWhereThereIsNoTable) {
  SearchFrame f;
  f.camera = {320, 240, 262, 159.5, 119.5};
  f.ray_depth_m = cv::Mat::zeros(240, 320, CV_32FC1);
  EXPECT_FALSE(estimate_table(f).has_value());
  std::mt19937 random(1);
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 320; ++x)
      f.ray_depth_m.at<float>(y, x) = 0.3F + 2e-4F * static_cast<float>(random() % 10000);
  }
  EXPECT_FALSE(estimate_table(f).has_value());
}

TEST(TableEstimate, IsDeterministic) {
  const SearchFrame f = table_scene(TableGeometry::from_pitch_roll(0.7, 0, 0.8), 3, 0.8);
  const auto a = estimate_table(f);
  const auto b = estimate_table(f);
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->table.camera_height_m, b->table.camera_height_m);
  EXPECT_EQ(a->table.up_in_camera, b->table.up_in_camera);
}

}  // namespace
}  // namespace sextant
