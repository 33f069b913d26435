// SPDX-License-Identifier: Apache-2.0
#include "offline/learn/nearest_feature.h"

#include <gtest/gtest.h>

#include <random>

namespace sextant {
namespace {

TEST(NearestFeature, IsExactAgainstBruteForce) {
  std::mt19937 random(4);
  for (const unsigned rarity : {4U, 40U, 400U}) {
    cv::Mat edges = cv::Mat::zeros(37, 53, CV_8UC1);
    std::vector<cv::Point> features;
    for (int y = 0; y < edges.rows; ++y) {
      for (int x = 0; x < edges.cols; ++x) {
        const unsigned kind = random() % 8;
        if (random() % rarity) continue;
        edges.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(1U << kind);
        if (kind == 2) features.emplace_back(x, y);
      }
    }
    if (features.empty()) continue;
    const auto nearest = nearest_features(edges, 2);
    for (int y = 0; y < edges.rows; ++y) {
      for (int x = 0; x < edges.cols; ++x) {
        int best = 1 << 30;
        for (const cv::Point& f : features)
          best = std::min(best, (f.x - x) * (f.x - x) + (f.y - y) * (f.y - y));
        const NearestFeature n = nearest[static_cast<std::size_t>(y * edges.cols + x)];
        ASSERT_EQ((n.column - x) * (n.column - x) + (n.row - y) * (n.row - y), best);
        ASSERT_EQ(edges.at<std::uint8_t>(n.row, n.column), 1U << 2);
      }
    }
  }
}

TEST(NearestFeature, OnlyTheRowsAskedForAreFilled) {
  cv::Mat edges = cv::Mat::zeros(9, 7, CV_8UC1);
  edges.at<std::uint8_t>(2, 3) = 1;
  edges.at<std::uint8_t>(8, 6) = 1;
  const auto all = nearest_features(edges, 0);
  std::vector<bool> rows(9, false);
  rows[0] = rows[7] = true;
  const auto some = nearest_features(edges, 0, rows);
  ASSERT_EQ(some.size(), all.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool wanted = rows[i / 7];
    EXPECT_EQ(some[i].column, wanted ? all[i].column : -1);
    EXPECT_EQ(some[i].row, wanted ? all[i].row : -1);
  }
}

TEST(NearestFeature, NoneWhereThereIsNone) {
  const auto nearest = nearest_features(cv::Mat::zeros(5, 6, CV_8UC1), 0);
  ASSERT_EQ(nearest.size(), 30U);
  for (const auto& n : nearest) EXPECT_EQ(n.column, -1);
}

}  // namespace
}  // namespace sextant
