// SPDX-License-Identifier: Apache-2.0
#include "runtime/features/edges.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

namespace sextant {
namespace {

TEST(EdgeKinds, AreTheTwoNearestOfEightLineDirections) {
  int checked = 0;
  for (int dx = -40; dx <= 40; ++dx) {
    for (int dy = -40; dy <= 40; ++dy) {
      if (dx == 0 && dy == 0) continue;
      // Line direction = gradient direction + 90 deg, modulo 180.
      double line = std::atan2(dx, -dy) * 180 / std::numbers::pi;
      line = std::fmod(line + 360, 180);
      const double steps = line / 22.5;
      if (std::abs(steps - std::round(steps)) < 1e-3) continue;  // on a border
      const int below = static_cast<int>(std::floor(steps)) % 8;
      ASSERT_EQ(edge_kinds(dx, dy), (1U << below) | (1U << ((below + 1) % 8))) << dx << " " << dy;
      ++checked;
    }
  }
  EXPECT_GT(checked, 6000);
}

TEST(Edges, ARotatedStripeGivesItsDirection) {
  for (int k = 0; k < 8; ++k) {
    cv::Mat image(200, 200, CV_8UC3, cv::Scalar(40, 40, 40));
    const double a = k * 22.5 * std::numbers::pi / 180;
    const cv::Point2d along(std::cos(a), std::sin(a));
    const cv::Point2d c(100, 100);
    cv::line(image, c - 80 * along, c + 80 * along, cv::Scalar(220, 200, 180), 15, cv::LINE_AA);
    const cv::Mat edges = edges_by_direction(image);
    int right = 0;
    int all = 0;
    for (int y = 0; y < 200; ++y) {
      for (int x = 0; x < 200; ++x) {
        const cv::Point2d d = cv::Point2d(x, y) - c;
        if (!edges.at<std::uint8_t>(y, x) || std::abs(d.dot(along)) > 65) continue;
        ++all;
        right += edges.at<std::uint8_t>(y, x) & (1U << static_cast<unsigned>(k)) ? 1 : 0;
      }
    }
    EXPECT_GT(all, 150);
    EXPECT_GT(right, 0.9 * all) << "direction " << k;
  }
}

TEST(Edges, ColourAloneMakesAnEdge) {
  cv::Mat image(60, 60, CV_8UC3, cv::Scalar(100, 100, 100));
  image.colRange(30, 60).setTo(cv::Scalar(100, 180, 60));
  EXPECT_GT(cv::countNonZero(edges_by_direction(image)), 40);
}

/// Grey squares on grey, contrast 60 grey levels and more where gain is 1.
cv::Mat squares(double gain) {
  cv::Mat image(120, 120, CV_8UC3, cv::Scalar::all(100 * gain));
  for (int y = 10; y < 100; y += 30) {
    for (int x = 10; x < 100; x += 30) {
      image(cv::Rect(x, y, 16, 16)).setTo(cv::Scalar::all((100 + (x + y) / 5 + 60) * gain));
    }
  }
  return image;
}

TEST(Edges, FrameThresholdsFollowDarkAndBlurredPictures) {
  const int bright = cv::countNonZero(edges_by_direction(squares(1), kFrameEdges));
  EXPECT_GT(bright, 500);
  // Dark: fixed thresholds lose nearly all, those of frames keep nearly all.
  const cv::Mat dark = squares(0.18);
  EXPECT_LT(cv::countNonZero(edges_by_direction(dark)), bright / 4);
  EXPECT_GT(cv::countNonZero(edges_by_direction(dark, kFrameEdges)), bright * 9 / 10);
  cv::Mat blurred;
  cv::GaussianBlur(squares(0.6), blurred, {}, 2.5);
  EXPECT_LT(cv::countNonZero(edges_by_direction(blurred)), bright / 4);
  EXPECT_GT(cv::countNonZero(edges_by_direction(blurred, kFrameEdges)), bright * 3 / 4);
}

TEST(Edges, FrameThresholdsNeverRise) {
  const cv::Mat image = squares(1.2);
  cv::Mat missed;
  cv::bitwise_and(edges_by_direction(image), ~edges_by_direction(image, kFrameEdges), missed);
  EXPECT_EQ(cv::countNonZero(missed), 0);
}

TEST(Edges, FrameThresholdsStayAboveTheNoise) {
  cv::Mat noise(120, 120, CV_8UC3);
  cv::theRNG().state = 5;
  cv::randn(noise, cv::Scalar::all(90), cv::Scalar::all(2.5));
  EXPECT_LT(cv::countNonZero(edges_by_direction(noise, kFrameEdges)), 120 * 120 / 100);
}

TEST(Edges, FlatImagesHaveNone) {
  EXPECT_EQ(cv::countNonZero(edges_by_direction(cv::Mat(60, 60, CV_8UC3, cv::Scalar(9, 90, 200)))), 0);
}

}  // namespace
}  // namespace sextant
