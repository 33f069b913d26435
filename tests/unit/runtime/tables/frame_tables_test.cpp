// SPDX-License-Identifier: Apache-2.0
// Tables against brute force.
#include "runtime/tables/frame_tables.h"

#include <gtest/gtest.h>

#include <random>

#include "runtime/tables/distance_transform.h"

namespace sextant {
namespace {

cv::Mat random_edges(std::mt19937& random, int width, int height, unsigned rarity) {
  cv::Mat edges = cv::Mat::zeros(height, width, CV_8UC1);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (random() % rarity == 0)
        edges.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(1U << (random() % 8));
    }
  }
  return edges;
}

TEST(DistanceTransform, IsExactWithinTheClipRadius) {
  std::mt19937 random(1);
  for (const unsigned rarity : {5U, 60U, 900U, 100000U}) {
    const int w = 61;
    const int h = 47;
    const cv::Mat edges = random_edges(random, w, h, rarity);
    for (const int clip : {1, 7, 100}) {
      std::vector<std::uint16_t> out(static_cast<std::size_t>(w * h));
      clipped_distance2(edges, 3, clip, out.data(), w);
      for (int y = 0; y < h; ++y) {
        for (int x = 0; x < w; ++x) {
          int best = 1 << 30;
          for (int v = 0; v < h; ++v) {
            for (int u = 0; u < w; ++u) {
              if (edges.at<std::uint8_t>(v, u) & 8U)
                best = std::min(best, (u - x) * (u - x) + (v - y) * (v - y));
            }
          }
          const int expected = best <= clip * clip ? best : 65535;
          ASSERT_EQ(out[static_cast<std::size_t>(y * w + x)], expected);
        }
      }
    }
  }
}

struct RandomTables {
  SearchFrame frame;
  cv::Mat edges;
  FrameTables tables;
  RandomTables() {
    std::mt19937 random(2);
    frame.camera = {50, 40, 50, 24.5, 19.5};
    frame.ray_depth_m = cv::Mat::zeros(40, 50, CV_32FC1);
    for (int y = 0; y < 40; ++y) {
      for (int x = 0; x < 50; ++x) {
        if (random() % 6)
          frame.ray_depth_m.at<float>(y, x) = 0.4F + 2.4e-8F * static_cast<float>(random() % 100000000);
      }
    }
    frame.ray_depth_m.at<float>(3, 3) = 50;  // deeper than the table can say
    edges = random_edges(random, 50, 40, 30);
    WorkerPool pool(2);
    tables.build(frame, edges, 20, pool);
  }
};

TEST(FrameTables, WindowsHoldTheExtremesOfTheirPixels) {
  const RandomTables r;
  const FrameTables& t = r.tables;
  const int w = t.stride();
  const int h = t.height() + 2;
  for (std::size_t level = 0; level < kWindowSides.size(); ++level) {
    const int l = static_cast<int>(level);
    for (int y = 0; y < h; y += 3) {
      for (int x = 0; x < w; x += 2) {
        unsigned nearest = 65535;
        unsigned farthest = 0;
        unsigned missing = 0;
        unsigned distance = 65535;
        for (int v = y; v < std::min(h, y + kWindowSides[level]); ++v) {
          for (int u = x; u < std::min(w, x + kWindowSides[level]); ++u) {
            nearest = std::min<unsigned>(nearest, t.nearest_depth(0)[v * w + u]);
            farthest = std::max<unsigned>(farthest, t.farthest_depth(0)[v * w + u]);
            missing = std::max<unsigned>(missing, t.any_missing(0)[v * w + u]);
            distance = std::min<unsigned>(distance, t.distance2(5, 0)[v * w + u]);
          }
        }
        ASSERT_EQ(t.nearest_depth(l)[y * w + x], nearest);
        ASSERT_EQ(t.farthest_depth(l)[y * w + x], farthest);
        ASSERT_EQ(t.any_missing(l)[y * w + x], missing);
        ASSERT_EQ(t.distance2(5, l)[y * w + x], distance);
      }
    }
  }
}

TEST(FrameTables, OutsideIsFarAndMissing) {
  const RandomTables r;
  const FrameTables& t = r.tables;
  EXPECT_EQ(t.clamp_x(-1000), 0);
  EXPECT_EQ(t.clamp_x(-1), 0);
  EXPECT_EQ(t.clamp_x(0), 1);
  EXPECT_EQ(t.clamp_x(49), 50);
  EXPECT_EQ(t.clamp_x(50), 51);
  EXPECT_EQ(t.clamp_x(9999), 51);
  EXPECT_EQ(t.clamp_y(40), 41);
  EXPECT_EQ(t.nearest_depth(0)[0], FrameTables::kMissing);
  EXPECT_EQ(t.any_missing(0)[0], 1);
  EXPECT_EQ(t.distance2(0, 0)[0], FrameTables::kFar);
}

TEST(FrameTables, DepthIsStoredToHalfAStep) {
  const RandomTables r;
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 50; ++x) {
      const float d = r.frame.ray_depth_m.at<float>(y, x);
      const auto stored = r.tables.nearest_depth(0)[(y + 1) * r.tables.stride() + x + 1];
      if (d == 0) {
        EXPECT_EQ(stored, FrameTables::kMissing);
      } else if (d < 3) {
        EXPECT_NEAR(static_cast<float>(stored) * FrameTables::kDepthUnit, d, FrameTables::kDepthUnit * 0.51F);
      } else {
        EXPECT_EQ(stored, FrameTables::kLargestDepth);
      }
    }
  }
}

TEST(FrameTables, LevelsCoverTheirSide) {
  for (int side = 1; side <= 96; ++side) {
    const auto level = static_cast<std::size_t>(FrameTables::level_for(side));
    EXPECT_GE(kWindowSides[level], side);
    if (level > 0) {
      EXPECT_LT(kWindowSides[level - 1], side);
    }
  }
  EXPECT_EQ(FrameTables::level_for(97), static_cast<int>(kWindowSides.size()));
}

}  // namespace
}  // namespace sextant
