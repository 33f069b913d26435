// SPDX-License-Identifier: Apache-2.0
#include "runtime/refine/edge_match.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "runtime/features/edges.h"

namespace sextant {
namespace {

TEST(NearestEdge, MeasuresAcrossALineOfAnyDirection) {
  for (int degrees = 0; degrees < 180; degrees += 15) {
    const double a = degrees * 3.14159265358979 / 180;
    // Half the picture is bright: an edge through (100, 100) along `a`.
    cv::Mat colour(200, 200, CV_8UC3, cv::Scalar(40, 40, 40));
    const Eigen::Vector2d normal(-std::sin(a), std::cos(a));
    for (int y = 0; y < 200; ++y) {
      for (int x = 0; x < 200; ++x) {
        if (normal.dot(Eigen::Vector2d(x - 100, y - 100)) > 0) colour.at<cv::Vec3b>(y, x) = {200, 200, 200};
      }
    }
    const cv::Mat edges = edges_by_direction(colour);
    double worst = 0;
    int missed = 0;
    for (int k = -30; k <= 30; ++k) {
      const double off = 0.13 * k;
      const Eigen::Vector2d from =
          Eigen::Vector2d(100, 100) - off * normal + 0.7 * k * Eigen::Vector2d(std::cos(a), std::sin(a));
      const auto found = nearest_edge(edges, from, normal, 6);
      // A step along the normal may slip between two edge pixels that touch at a corner.
      if (!found) {
        ++missed;
        continue;
      }
      worst = std::max(worst, std::abs(*found - off));
      const auto reversed = nearest_edge(edges, from, -normal, 6);
      if (reversed) {
        EXPECT_NEAR(*reversed, -*found, 1.01);
      }
    }
    EXPECT_LE(missed, 6) << degrees;  // of 61
    EXPECT_LT(worst, 1.6) << degrees;
    // Nothing of that direction across.
    EXPECT_FALSE(nearest_edge(edges, {100, 100}, {normal.y(), -normal.x()}, 6)) << degrees;
  }
}

TEST(NearestEdge, TwoEquallyNearOnesAreNoAnswer) {
  cv::Mat edges(50, 50, CV_8UC1, cv::Scalar(0));
  edges.row(20).setTo(1);  // horizontal edges are of kind 0
  edges.row(30).setTo(1);
  EXPECT_FALSE(nearest_edge(edges, {25, 25}, {0, 1}, 8));
  EXPECT_DOUBLE_EQ(nearest_edge(edges, {25, 26}, {0, 1}, 8).value(), 4);
  EXPECT_FALSE(nearest_edge(edges, {25, 26}, {0, 1}, 3));
}

TEST(NearestEdge, LooksAtNothingOutsideTheImage) {
  const cv::Mat edges(50, 50, CV_8UC1, cv::Scalar(255));
  EXPECT_FALSE(nearest_edge(edges, {-20, -20}, {1, 0}, 8));
  EXPECT_TRUE(nearest_edge(edges, {-5, 10}, {1, 0}, 8));
}

}  // namespace
}  // namespace sextant
