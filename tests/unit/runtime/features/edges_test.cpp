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

TEST(Edges, FlatImagesHaveNone) {
  EXPECT_EQ(cv::countNonZero(edges_by_direction(cv::Mat(60, 60, CV_8UC3, cv::Scalar(9, 90, 200)))), 0);
}

}  // namespace
}  // namespace sextant
