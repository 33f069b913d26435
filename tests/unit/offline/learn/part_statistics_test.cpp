// SPDX-License-Identifier: Apache-2.0
// Statistics of parts against scenes whose content is known.
#include "offline/learn/part_statistics.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sextant {
namespace {

const PinholeCamera kCamera{200, 200, 500, 99.5, 99.5};

/// A scene at 1 m around pixel (100, 100): an edge of kind 4 `edge_off` pixels right of the centre (none
/// where negative), and the same depth everywhere.
TestScene scene(SceneTruth truth, int edge_off, float depth_m) {
  TestScene s;
  s.truth = truth;
  s.view.hypothesis = {100, 100, 1, 0, 0, 0};
  s.view.window = {60, 60, 81, 81};
  s.view.edges = cv::Mat::zeros(81, 81, CV_8UC1);
  if (edge_off >= 0) s.view.edges.at<std::uint8_t>(40, 40 + edge_off) = 1U << 4;
  s.view.ray_depth_m = cv::Mat(81, 81, CV_32FC1, cv::Scalar(depth_m));
  return s;
}

VisualPart edge_part() {
  VisualPart part;
  part.kind = 4;
  part.u[0] = 10 / 500.0F;
  part.variance = 1e-6F;
  part.radius = 0.01F;
  return part;
}

DepthPart depth_part() {
  DepthPart part;
  part.d[0] = -0.05F;
  part.variance = 1e-6F;
  part.radius = 0.02F;
  return part;
}

TEST(PartStatistics, CountWhereEdgesAreFound) {
  std::vector<TestScene> scenes;
  // On the object found in 30 of 40 scenes; in clutter in 4 of 40, on the turned object in 20 of 40.
  for (int i = 0; i < 40; ++i) {
    scenes.push_back(scene(SceneTruth::kObject, i < 30 ? 10 + i % 2 : -1, 1));
    scenes.push_back(scene(SceneTruth::kClutter, i < 4 ? 10 : 35, 1));
    scenes.push_back(scene(SceneTruth::kTurnedObject, i < 20 ? 10 : -1, 1));
  }
  std::vector<VisualPart> parts{edge_part()};
  measure_parts(scenes, kCamera, parts);
  EXPECT_NEAR(parts[0].seen.found, 0.75, 0.02);
  EXPECT_NEAR(parts[0].seen.background, 0.5 * (0.1 + 0.5), 0.03);
  // Half of the found ones are off by a pixel in one of two axes.
  EXPECT_NEAR(parts[0].seen.spread, 0.25 / (500.0 * 500.0), 0.15 / (500.0 * 500.0));
}

TEST(PartStatistics, MissingDepthIsNoVote) {
  std::vector<TestScene> scenes;
  for (int i = 0; i < 40; ++i) {
    scenes.push_back(
        scene(SceneTruth::kObject, -1, i < 20 ? 0.0F : 0.95F + 0.002F * static_cast<float>(i % 3 - 1)));
    scenes.push_back(scene(SceneTruth::kClutter, -1, i < 30 ? 0.7F : 0.95F));
  }
  std::vector<DepthPart> parts{depth_part()};
  measure_parts(scenes, kCamera, parts);
  EXPECT_GT(parts[0].seen.found, 0.95);
  EXPECT_EQ(parts[0].seen.background, PartStatistics{}.background);  // is not measured for depth
  EXPECT_GT(std::sqrt(parts[0].seen.spread), 0.0012);
  EXPECT_LT(std::sqrt(parts[0].seen.spread), 0.0025);
}

TEST(PartStatistics, WithoutScenesNothingIsMeasured) {
  std::vector<VisualPart> parts{edge_part()};
  measure_parts({}, kCamera, parts);
  EXPECT_EQ(parts[0].seen.spread, 0);
}

}  // namespace
}  // namespace sextant
