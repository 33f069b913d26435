// SPDX-License-Identifier: Apache-2.0
// Against interpolation in doubles at every pixel, also on and beyond the border.
#include "runtime/frame/colour_remap.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace sextant {
namespace {

cv::Mat noise(int width, int height) {
  cv::Mat image(height, width, CV_8UC3);
  cv::RNG random(7);
  random.fill(image, cv::RNG::UNIFORM, 0, 256);
  return image;
}

double exact(const cv::Mat& image, double x, double y, int channel) {
  const double u = std::clamp(x, 0.0, image.cols - 1.0);
  const double v = std::clamp(y, 0.0, image.rows - 1.0);
  const int left = std::min(static_cast<int>(u), image.cols - 2);
  const int top = std::min(static_cast<int>(v), image.rows - 2);
  const auto at = [&](int dx, int dy) -> double { return image.at<cv::Vec3b>(top + dy, left + dx)[channel]; };
  const double upper = at(0, 0) + (u - left) * (at(1, 0) - at(0, 0));
  const double lower = at(0, 1) + (u - left) * (at(1, 1) - at(0, 1));
  return upper + (v - top) * (lower - upper);
}

TEST(ColourRemap, InterpolatesAsDoublesDo) {
  const cv::Mat image = noise(37, 23);
  cv::Mat map(50, 60, CV_32FC2);
  std::mt19937 random(3);
  std::uniform_int_distribution<int> across(-3 * 64, 39 * 64);
  std::uniform_int_distribution<int> along(-3 * 64, 25 * 64);
  for (int y = 0; y < map.rows; ++y) {
    for (int x = 0; x < map.cols; ++x)
      map.at<cv::Vec2f>(y, x) = {static_cast<float>(across(random)) / 64,
                                 static_cast<float>(along(random)) / 64};
  }
  const cv::Mat out = ColourRemap(map, image.size())(image);
  ASSERT_EQ(out.size(), map.size());
  for (int y = 0; y < map.rows; ++y) {
    for (int x = 0; x < map.cols; ++x) {
      const cv::Vec2f place = map.at<cv::Vec2f>(y, x);
      for (int k = 0; k < 3; ++k)
        ASSERT_NEAR(out.at<cv::Vec3b>(y, x)[k], exact(image, place[0], place[1], k), 0.5 + 1e-9)
            << x << " " << y;
    }
  }
}

TEST(ColourRemap, RoundsPlacesToASixtyFourth) {
  const cv::Mat image = noise(37, 23);
  cv::Mat map(23, 37, CV_32FC2);
  std::mt19937 random(4);
  std::uniform_real_distribution<float> shift(-0.5F, 0.5F);
  for (int y = 0; y < map.rows; ++y) {
    for (int x = 0; x < map.cols; ++x)
      map.at<cv::Vec2f>(y, x) = {static_cast<float>(x) + shift(random),
                                 static_cast<float>(y) + shift(random)};
  }
  const cv::Mat out = ColourRemap(map, image.size())(image);
  for (int y = 0; y < map.rows; ++y) {
    for (int x = 0; x < map.cols; ++x) {
      const cv::Vec2f place = map.at<cv::Vec2f>(y, x);
      // At most 1/128 pixel in both directions of a step of 255.
      for (int k = 0; k < 3; ++k)
        ASSERT_NEAR(out.at<cv::Vec3b>(y, x)[k], exact(image, place[0], place[1], k), 0.5 + 2 * 255.0 / 128);
    }
  }
}

TEST(ColourRemap, TheIdentityChangesNothingAndAPartOfAnImageWillDo) {
  const cv::Mat large = noise(50, 40);
  const cv::Mat part = large(cv::Rect(5, 6, 33, 21));  // its rows are not contiguous
  cv::Mat map(part.size(), CV_32FC2);
  for (int y = 0; y < map.rows; ++y) {
    for (int x = 0; x < map.cols; ++x)
      map.at<cv::Vec2f>(y, x) = {static_cast<float>(x), static_cast<float>(y)};
  }
  EXPECT_EQ(cv::norm(ColourRemap(map, part.size())(part), part, cv::NORM_INF), 0);
}

TEST(ColourRemap, PlacesThatAreNoneTakeTheBorder) {
  const cv::Mat image = noise(4, 3);
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  cv::Mat map(1, 3, CV_32FC2);
  map.at<cv::Vec2f>(0, 0) = {kNan, kNan};
  map.at<cv::Vec2f>(0, 1) = {kInfinity, 1e30F};
  map.at<cv::Vec2f>(0, 2) = {-kInfinity, -1e30F};
  const cv::Mat out = ColourRemap(map, image.size())(image);
  EXPECT_EQ(out.at<cv::Vec3b>(0, 0), image.at<cv::Vec3b>(0, 0));
  EXPECT_EQ(out.at<cv::Vec3b>(0, 1), image.at<cv::Vec3b>(2, 3));
  EXPECT_EQ(out.at<cv::Vec3b>(0, 2), image.at<cv::Vec3b>(0, 0));
}

}  // namespace
}  // namespace sextant
