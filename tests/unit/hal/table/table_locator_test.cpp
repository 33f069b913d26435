// SPDX-License-Identifier: Apache-2.0
#include "hal/table/table_locator.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "runtime/base/error.h"

namespace sextant {
namespace {

RgbdFrame table_frame(const TableGeometry& table, int ms, unsigned seed) {
  RgbdFrame f;
  f.camera = {.width = 160, .height = 120, .fx = 140, .fy = 140, .cx = 79.5, .cy = 59.5};
  f.colour = cv::Mat::zeros(120, 160, CV_8UC3);
  f.axial_depth_m = cv::Mat::zeros(120, 160, CV_32FC1);
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, 0.002);
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 160; ++x) {
      const Eigen::Vector3d ray((x - 79.5) / 140, (y - 59.5) / 140, 1);
      const double down = -table.up_in_camera.dot(ray);
      if (down > 0.2)
        f.axial_depth_m.at<float>(y, x) = static_cast<float>(table.camera_height_m / down + noise(random));
    }
  }
  f.captured_monotonic = MonotonicTime(std::chrono::hours(1) + std::chrono::milliseconds(ms));
  return f;
}

std::string refusal(TableLocator& locator, RgbdFrame frame) {
  try {
    locator.locate(frame);
  } catch (const InputError& error) {
    return error.what();
  }
  return "located";
}

const TableGeometry kTable = TableGeometry::from_pitch_roll(0.8, 0.02, 0.6);

TEST(TableLocator, EstimatesAndFilters) {
  TableLocator locator({});
  RgbdFrame frame;
  for (int i = 0; i < 20; ++i) {
    frame = table_frame(kTable, 33 * i, static_cast<unsigned>(i));
    locator.locate(frame);
  }
  EXPECT_NEAR(frame.table->camera_height_m, 0.6, 0.001);
  EXPECT_NEAR(frame.table->pitch_rad(), 0.8, 0.002);
  ASSERT_TRUE(locator.last_estimate());
  EXPECT_LT(frame.table_uncertainty->height_m, locator.last_estimate()->uncertainty.height_m);
  // A hand before the camera: the table stays known for a while, then it is refused with the reason.
  RgbdFrame blind = table_frame(kTable, 700, 1);
  blind.axial_depth_m.setTo(0);
  locator.locate(blind);
  EXPECT_NEAR(blind.table->camera_height_m, 0.6, 0.001);
  blind.captured_monotonic += std::chrono::seconds(5);
  EXPECT_THAT(refusal(locator, blind), testing::HasSubstr("samples have depth"));
}

TEST(TableLocator, WithoutTheFilterEveryFrameStandsForItself) {
  TableLocator locator({.filter = false});
  RgbdFrame first = table_frame(kTable, 0, 1);
  locator.locate(first);
  RgbdFrame other = table_frame(TableGeometry::from_pitch_roll(0.5, 0, 0.9), 33, 1);
  locator.locate(other);
  EXPECT_NEAR(other.table->camera_height_m, 0.9, 0.005);
  other.axial_depth_m.setTo(0);
  EXPECT_THAT(refusal(locator, other), testing::HasSubstr("samples have depth"));
}

TEST(TableLocator, FixedWithItsUncertainty) {
  TableLocator locator({.origin = TableOrigin::kFixed,
                        .fixed = kTable,
                        .height_deviation_m = 0.003,
                        .tilt_deviation_rad = 0.01});
  RgbdFrame frame = table_frame(kTable, 0, 1);
  locator.locate(frame);
  EXPECT_EQ(frame.table->camera_height_m, 0.6);
  EXPECT_EQ(frame.table_uncertainty->height_m, 0.003);
  EXPECT_GT(frame.table_uncertainty->surface_m, 0.003);
}

TEST(TableLocator, TheFramesOwnOrAnError) {
  TableLocator locator({.origin = TableOrigin::kFrame});
  RgbdFrame frame = table_frame(kTable, 0, 1);
  EXPECT_THAT(refusal(locator, frame), testing::HasSubstr("does not say where the table is"));
  frame.table = kTable;
  EXPECT_EQ(refusal(locator, frame), "located");
}

TEST(TableLocator, AFixedPriorRulesOutOtherPlanes) {
  TableLocatorOptions options;
  options.filter = false;
  options.prior = TableLocatorOptions::Prior::kFixed;
  options.fixed = TableGeometry::from_pitch_roll(0.2, 0, 1);
  TableLocator wrong(options);
  EXPECT_THAT(refusal(wrong, table_frame(kTable, 0, 1)), testing::HasSubstr("plane"));
  options.fixed = TableGeometry::from_pitch_roll(0.75, 0, 1);
  TableLocator right(options);
  EXPECT_EQ(refusal(right, table_frame(kTable, 0, 1)), "located");
}

}  // namespace
}  // namespace sextant
