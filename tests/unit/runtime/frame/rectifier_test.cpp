// SPDX-License-Identifier: Apache-2.0
// What a Rectifier keeps between frames must not be seen in its results.
#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>
#include <random>

#include "runtime/frame/search_frame.h"

namespace sextant {
namespace {

RgbdFrame frame(int width, int height, double fx, double fy, double k1, unsigned seed) {
  RgbdFrame f;
  f.camera = {.width = width,
              .height = height,
              .fx = fx,
              .fy = fy,
              .cx = 0.5 * width,
              .cy = 0.5 * height,
              .distortion = {k1}};
  f.colour = cv::Mat(height, width, CV_8UC3);
  f.axial_depth_m = cv::Mat(height, width, CV_32FC1);
  std::mt19937 random(seed);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int k = 0; k < 3; ++k) f.colour.at<cv::Vec3b>(y, x)[k] = static_cast<std::uint8_t>(random());
      f.axial_depth_m.at<float>(y, x) = random() % 5 == 0 ? 0.0F : 1.0F + 1e-4F * static_cast<float>(x);
    }
  }
  return f;
}

void expect_same(const SearchFrame& a, const SearchFrame& b) {
  ASSERT_EQ(a.colour.size(), b.colour.size());
  EXPECT_EQ(cv::norm(a.colour, b.colour, cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(a.ray_depth_m, b.ray_depth_m, cv::NORM_INF), 0);
  EXPECT_EQ(a.camera.focal, b.camera.focal);
}

TEST(Rectifier, OneForManyFramesIsAsGoodAsOneEach) {
  Rectifier kept(0);
  for (unsigned seed = 0; seed < 6; ++seed) {
    // The calibration changes on the way and returns.
    const RgbdFrame f = seed % 3 == 1   ? frame(200, 150, 180, 170, 0.1, seed)
                        : seed % 3 == 2 ? frame(160, 120, 150, 150, 0, seed)
                                        : frame(200, 150, 180, 180, 0, seed);
    expect_same(kept.rectified(f), rectified(f));
  }
}

// Shrinking averages: one bright pixel in sixteen keeps its share of the light, wherever it lies.
TEST(Rectifier, ShrinkingLosesNoPixel) {
  for (int offset = 0; offset < 4; ++offset) {
    RgbdFrame f = frame(320, 240, 300, 300, 0, 1);
    f.colour.setTo(cv::Scalar::all(0));
    for (int y = offset; y < 240; y += 4) {
      for (int x = offset; x < 320; x += 4) f.colour.at<cv::Vec3b>(y, x) = {240, 240, 240};
    }
    const SearchFrame s = rectified(f, 80);
    EXPECT_EQ(s.colour.cols, 80);
    EXPECT_NEAR(cv::mean(s.colour)[0], 15, 1.5) << offset;
  }
}

// A gradient keeps its place when the frame is shrunk: pixel centres, not corners, are scaled.
TEST(Rectifier, ShrinkingMovesNothing) {
  RgbdFrame f = frame(320, 240, 300, 290, 0, 1);
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 320; ++x) f.colour.at<cv::Vec3b>(y, x) = {static_cast<std::uint8_t>(x / 2), 0, 0};
  }
  const SearchFrame s = rectified(f, 160);
  for (int x = 10; x < 150; ++x) {
    const Eigen::Vector2d tangent = s.camera.tangent(x, 60);
    const double source_x = f.camera.distorted_pixel(tangent).x();
    EXPECT_NEAR(s.colour.at<cv::Vec3b>(60, x)[0], source_x / 2 - 0.25, 1.0) << x;
  }
}

}  // namespace
}  // namespace sextant
