// SPDX-License-Identifier: Apache-2.0
#include "runtime/frame/table_filter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace sextant {
namespace {

using std::chrono::milliseconds;

constexpr double kTilt = 0.004;
constexpr double kHeight = 0.003;

KnownTable estimate(double pitch, double roll, double height) {
  return {TableGeometry::from_pitch_roll(pitch, roll, height), {kHeight, kTilt, kTilt, kTilt, kHeight}};
}

double pitch_error(const TableFilter& filter, milliseconds at, double truth) {
  return std::abs(filter.at(at)->table.pitch_rad() - truth);
}

TEST(TableFilter, AveragesWhileTheCameraStands) {
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0, 1);
  double single = 0;
  double filtered = 0;
  for (int run = 0; run < 20; ++run) {
    TableFilter filter;
    KnownTable last;
    for (int i = 0; i < 60; ++i) {
      last = estimate(0.7 + kTilt * noise(random), kTilt * noise(random), 0.8 + kHeight * noise(random));
      filter.update(last, milliseconds(33 * i));
    }
    single += std::abs(last.table.camera_height_m - 0.8);
    filtered += std::abs(filter.at(milliseconds(33 * 59))->table.camera_height_m - 0.8);
  }
  EXPECT_LT(filtered, 0.6 * single);
  EXPECT_GT(filtered, 0);
}

TEST(TableFilter, UncertaintyShrinksToHalfAndNoFurther) {
  TableFilter filter;
  for (int i = 0; i < 100; ++i) filter.update(estimate(0.7, 0, 0.8), milliseconds(33 * i));
  const KnownTable now = *filter.at(milliseconds(33 * 99));
  EXPECT_NEAR(now.uncertainty.height_m, 0.5 * kHeight, 1e-4);
  EXPECT_NEAR(now.uncertainty.tilt_rad, 0.5 * kTilt, 1e-4);
  EXPECT_NEAR(now.uncertainty.surface_m, 0.5 * kHeight, 1e-4);
}

TEST(TableFilter, OneBadFrameChangesNothing) {
  TableFilter filter;
  for (int i = 0; i < 10; ++i) EXPECT_TRUE(filter.update(estimate(0.7, 0, 0.8), milliseconds(33 * i)));
  EXPECT_FALSE(filter.update(estimate(0.3, 0.2, 1.5), milliseconds(330)));
  EXPECT_LT(pitch_error(filter, milliseconds(330), 0.7), 1e-9);
  EXPECT_TRUE(filter.update(estimate(0.7, 0, 0.8), milliseconds(363)));
  // Bad frames that do not agree with each other never become the table.
  for (int i = 0; i < 20; ++i) {
    EXPECT_FALSE(
        filter.update(estimate(0.2 + 0.05 * (i % 4), 0.2, 1.2 + 0.1 * (i % 3)), milliseconds(400 + i)));
  }
  EXPECT_EQ(filter.restarts(), 0);
}

TEST(TableFilter, FollowsACameraThatHasMoved) {
  TableFilter filter;
  for (int i = 0; i < 10; ++i) filter.update(estimate(0.7, 0, 0.8), milliseconds(33 * i));
  for (int i = 0; i < 3; ++i) filter.update(estimate(0.9, 0, 0.6), milliseconds(330 + 33 * i));
  EXPECT_EQ(filter.restarts(), 1);
  EXPECT_LT(pitch_error(filter, milliseconds(400), 0.9), 1e-6);
}

TEST(TableFilter, AnOldTableIsNone) {
  TableFilter filter;
  EXPECT_FALSE(filter.at(milliseconds(0)));
  filter.update(estimate(0.7, 0, 0.8), milliseconds(0));
  EXPECT_TRUE(filter.at(milliseconds(1900)));
  EXPECT_GT(filter.at(milliseconds(1900))->uncertainty.height_m,
            filter.at(milliseconds(0))->uncertainty.height_m);
  EXPECT_FALSE(filter.at(milliseconds(2100)));
  // Rejected ones keep nothing alive.
  filter.update(estimate(0.2, 0, 1.8), milliseconds(1950));
  EXPECT_FALSE(filter.at(milliseconds(2100)));
  // After the gap, whatever comes is taken.
  EXPECT_TRUE(filter.update(estimate(0.2, 0, 1.8), milliseconds(2200)));
  EXPECT_LT(pitch_error(filter, milliseconds(2200), 0.2), 1e-9);
}

TEST(TableFilter, AClockThatRunsBackwardsBeginsAgain) {
  TableFilter filter;
  filter.update(estimate(0.7, 0, 0.8), milliseconds(100000));
  EXPECT_TRUE(filter.update(estimate(0.9, 0, 0.6), milliseconds(0)));
  EXPECT_LT(pitch_error(filter, milliseconds(0), 0.9), 1e-9);
}

}  // namespace
}  // namespace sextant
