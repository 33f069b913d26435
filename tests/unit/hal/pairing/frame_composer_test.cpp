// SPDX-License-Identifier: Apache-2.0
#include "hal/pairing/frame_composer.h"

#include <gtest/gtest.h>

#include "runtime/base/error.h"

namespace sextant {
namespace {

CameraModel camera(int width, int height, double fx, double fy, double k1 = 0) {
  CameraModel c{.width = width, .height = height, .fx = fx, .fy = fy, .cx = 0.5 * width, .cy = 0.5 * height};
  c.distortion[0] = k1;
  return c;
}

cv::Mat colour_of(const CameraModel& c) { return {c.height, c.width, CV_8UC3, cv::Scalar(40, 80, 120)}; }
cv::Mat depth_of(const CameraModel& c, double z) { return {c.height, c.width, CV_32FC1, cv::Scalar(z)}; }

TEST(FrameComposer, PassesARegisteredPairThrough) {
  RgbdCalibration calibration;
  calibration.colour = camera(320, 240, 300, 300);
  calibration.depth_is_registered = true;
  FrameComposer composer(calibration, {.rectify = true}, "test");
  const cv::Mat colour = colour_of(calibration.colour);
  const cv::Mat depth = depth_of(calibration.colour, 1);
  const RgbdFrame frame = composer.compose(colour, depth);
  EXPECT_EQ(frame.colour.data, colour.data);
  EXPECT_EQ(frame.axial_depth_m.data, depth.data);
  EXPECT_EQ(frame.camera.fx, 300);
}

TEST(FrameComposer, RegistersAndKeepsTheLens) {
  RgbdCalibration calibration;
  calibration.colour = camera(320, 240, 300, 290, 0.05);
  calibration.depth = camera(160, 120, 130, 130);
  calibration.colour_from_depth.translation().x() = 0.03;
  FrameComposer composer(calibration, {}, "test");
  const RgbdFrame frame = composer.compose(colour_of(calibration.colour), depth_of(calibration.depth, 1));
  EXPECT_EQ(frame.camera.distortion[0], 0.05);
  EXPECT_EQ(frame.axial_depth_m.size(), cv::Size(320, 240));
  EXPECT_FLOAT_EQ(frame.axial_depth_m.at<float>(120, 160), 1);
}

TEST(FrameComposer, RectifiesAndResamplesBothInOneStep) {
  RgbdCalibration calibration;
  calibration.colour = camera(640, 480, 600, 580, 0.08);
  calibration.depth = camera(320, 240, 280, 280);
  FrameComposer composer(calibration, {.rectify = true, .width = 320}, "test");
  const RgbdFrame frame = composer.compose(colour_of(calibration.colour), depth_of(calibration.depth, 0.8));
  EXPECT_TRUE(frame.camera.is_ideal());
  EXPECT_EQ(frame.colour.size(), cv::Size(320, 240));
  EXPECT_EQ(frame.axial_depth_m.size(), cv::Size(320, 240));
  EXPECT_EQ(composer.camera().width, 320);
  int filled = 0;
  for (int y = 20; y < 220; ++y) {
    for (int x = 20; x < 300; ++x) {
      EXPECT_TRUE(frame.axial_depth_m.at<float>(y, x) == 0 ||
                  std::abs(frame.axial_depth_m.at<float>(y, x) - 0.8F) < 1e-5F);
      filled += frame.axial_depth_m.at<float>(y, x) > 0 ? 1 : 0;
    }
  }
  EXPECT_EQ(filled, 200 * 280);  // a plane without holes has none afterwards
  // The search finds such a frame ready: its own rectification has nothing left to do.
  EXPECT_EQ(rectified(frame).colour.data, frame.colour.data);
}

TEST(FrameComposer, RegisteredDepthIsRectifiedToo) {
  RgbdCalibration calibration;
  calibration.colour = camera(320, 240, 300, 290, 0.1);
  calibration.depth_is_registered = true;
  FrameComposer composer(calibration, {.rectify = true}, "test");
  cv::Mat depth = depth_of(calibration.colour, 1);
  const Eigen::Vector2d tangent(0.3, -0.2);
  const Eigen::Vector2d at = calibration.colour.distorted_pixel(tangent);
  depth(cv::Rect(static_cast<int>(at.x()) - 3, static_cast<int>(at.y()) - 3, 7, 7)).setTo(0.5);
  const RgbdFrame frame = composer.compose(colour_of(calibration.colour), depth);
  const Eigen::Vector2d there = frame.camera.distorted_pixel(tangent);
  EXPECT_FLOAT_EQ(frame.axial_depth_m.at<float>(static_cast<int>(there.y()), static_cast<int>(there.x())),
                  0.5);
}

TEST(FrameComposer, RefusesImagesOfAnotherSize) {
  RgbdCalibration calibration;
  calibration.colour = camera(320, 240, 300, 300);
  calibration.depth = camera(160, 120, 140, 140);
  FrameComposer composer(calibration, {}, "test");
  EXPECT_THROW(composer.compose(colour_of(calibration.depth), depth_of(calibration.depth, 1)), InputError);
  EXPECT_THROW(composer.compose(colour_of(calibration.colour), depth_of(calibration.colour, 1)), InputError);
  calibration.depth.fx = -1;
  EXPECT_THROW(FrameComposer(calibration, {}, "test"), InputError);
}

}  // namespace
}  // namespace sextant
