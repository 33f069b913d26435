// SPDX-License-Identifier: Apache-2.0
#include "runtime/refine/depth_outline.h"

#include <gtest/gtest.h>

#include "tests/unit/runtime/refine/refine_scene.h"

namespace sextant {
namespace {

using namespace test;

const TableGeometry kTable = TableGeometry::from_pitch_roll(40 * kDegree, 0, 0.6);

/// A box with one wide face to the camera, as it is and moved sideways along that face.
struct SlidBox {
  ObjectModel model = model_of(box_mesh({0.08F, 0.035F, 0.1F}), 0.1, 180);
  RigidTransform truth = standing(model, kTable, 320, 240, 0.1);
  RigidTransform slid = truth;
  Scene scene = make_scene({{&model.mesh, truth}}, kTable, "none", 0);
  DepthRaster raster;
  std::vector<EdgeSample> samples;

  explicit SlidBox(double metres) {
    slid.translation() += metres * truth.linear().col(0);
    raster.draw(model.mesh, slid, kCamera);
    ContourEdges(model).sample(slid, kCamera, raster, 3, samples);
  }
};

bool covered(const DepthRaster& raster, const Eigen::Vector2d& p) {
  return raster.triangle(static_cast<int>(std::lround(p.x())), static_cast<int>(std::lround(p.y()))) !=
         DepthRaster::kBackground;
}

TEST(DepthOutline, LeadsToWhereTheSurfaceEnds) {
  const SlidBox b(0.012);
  DepthRaster real;
  real.draw(b.model.mesh, b.truth, kCamera);
  int found = 0;
  double farthest = 0;
  for (const EdgeSample& s : b.samples) {
    if (s.origin != EdgeOrigin::kSilhouette) continue;
    const auto distance = depth_outline_at(b.scene.frame, b.raster, s, 14);
    if (!distance) continue;
    ++found;
    farthest = std::max(farthest, std::abs(*distance));
    const Eigen::Vector2d end = s.pixel + *distance * s.normal;
    EXPECT_NE(covered(real, end + 2 * s.normal), covered(real, end - 2 * s.normal)) << s.pixel.transpose();
  }
  EXPECT_GT(found, 30);
  EXPECT_GT(farthest, 6);
}

TEST(DepthOutline, WhatStandsInFrontOrIsMissingSaysNothing) {
  SlidBox b(0.012);
  const auto found = [&] {
    int n = 0;
    for (const EdgeSample& s : b.samples) {
      n += s.origin == EdgeOrigin::kSilhouette && depth_outline_at(b.scene.frame, b.raster, s, 14) ? 1 : 0;
    }
    return n;
  };
  ASSERT_GT(found(), 30);
  const cv::Mat depth = b.scene.frame.ray_depth_m.clone();
  b.scene.frame.ray_depth_m = depth * 0.8;
  EXPECT_EQ(found(), 0);
  b.scene.frame.ray_depth_m = depth * 0;
  EXPECT_EQ(found(), 0);
}

TEST(DepthOutline, BringsABoxBackThatSlidAlongItsFace) {
  for (const double metres : {-0.015, -0.008, 0.008, 0.015}) {
    const SlidBox b(metres);
    Refiner refiner(b.model);
    const cv::Mat no_edges = cv::Mat::zeros(b.scene.edges.size(), CV_8UC1);
    const RefinedPose refined = refiner.refine({b.scene.frame, no_edges, kTable, TableTolerance{}}, b.slid);
    EXPECT_LT((refined.camera_from_object.translation() - b.truth.translation()).norm(), 0.003) << metres;
  }
}

}  // namespace
}  // namespace sextant
