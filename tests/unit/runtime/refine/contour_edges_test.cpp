// SPDX-License-Identifier: Apache-2.0
#include "runtime/refine/contour_edges.h"

#include <gtest/gtest.h>

#include <map>

#include "tests/unit/runtime/refine/refine_scene.h"

namespace sextant {
namespace {

using namespace test;

const TableGeometry kTable = TableGeometry::from_pitch_roll(40 * kDegree, 0, 0.6);

std::vector<EdgeSample> samples_of(const ObjectModel& model, const RigidTransform& pose) {
  ContourEdges contours(model);
  DepthRaster raster;
  raster.draw(model.mesh, pose, kCamera);
  std::vector<EdgeSample> samples;
  contours.sample(pose, kCamera, raster, 3, samples);
  return samples;
}

TEST(ContourEdges, ABoxShowsItsThreeVisibleFaces) {
  const ObjectModel model = model_of(box_mesh({0.08F, 0.05F, 0.1F}), 0.1, 180);
  const RigidTransform pose = standing(model, kTable, 320, 240, 0.6);
  std::map<EdgeOrigin, double> length;
  const Eigen::Vector3d half(0.08, 0.05, 0.1);
  for (const EdgeSample& s : samples_of(model, pose)) {
    length[s.origin] += s.spacing_px;
    // On an edge of the box: at least two coordinates at their extremes.
    const Eigen::Vector3d p = (pose.inverse() * s.point).cwiseAbs() - half;
    int extremes = 0;
    for (int i = 0; i < 3; ++i) extremes += std::abs(p[i]) < 1e-4 ? 1 : 0;
    EXPECT_GE(extremes, 2);
    EXPECT_LT((kCamera.project(s.point) - s.pixel).norm(), 1e-6);
  }
  // Six outer edges and three inner ones, all seen; the three at the hidden corner are not.
  double outer = 0;
  double inner = 0;
  const auto corner = [&](int x, int y, int z) {
    return kCamera.project(pose * Eigen::Vector3d(x * half.x(), y * half.y(), z * half.z()));
  };
  const Eigen::Vector3d eye = pose.inverse() * Eigen::Vector3d::Zero();
  const int sx = eye.x() > 0 ? 1 : -1;
  const int sy = eye.y() > 0 ? 1 : -1;
  inner += (corner(sx, sy, 1) - corner(-sx, sy, 1)).norm() + (corner(sx, sy, 1) - corner(sx, -sy, 1)).norm() +
           (corner(sx, sy, 1) - corner(sx, sy, -1)).norm();
  outer +=
      (corner(-sx, sy, 1) - corner(-sx, -sy, 1)).norm() + (corner(sx, -sy, 1) - corner(-sx, -sy, 1)).norm() +
      (corner(-sx, sy, 1) - corner(-sx, sy, -1)).norm() + (corner(sx, -sy, 1) - corner(sx, -sy, -1)).norm() +
      (corner(-sx, sy, -1) - corner(sx, sy, -1)).norm() + (corner(sx, -sy, -1) - corner(sx, sy, -1)).norm();
  EXPECT_NEAR(length[EdgeOrigin::kCrease], inner, 0.05 * inner);
  EXPECT_NEAR(length[EdgeOrigin::kSilhouette], outer, 0.05 * outer);
}

TEST(ContourEdges, WindingDoesNotMatter) {
  ObjectModel model = model_of(box_mesh({0.08F, 0.05F, 0.1F}), 0.1, 180);
  const RigidTransform pose = standing(model, kTable, 320, 240, 0.6);
  const std::size_t before = samples_of(model, pose).size();
  for (std::size_t t = 0; t < model.mesh.triangles.size(); t += 3) {
    std::swap(model.mesh.triangles[t][1], model.mesh.triangles[t][2]);
  }
  EXPECT_EQ(samples_of(model, pose).size(), before);
}

TEST(ContourEdges, ARoundSideHasASilhouetteAndNoCreases) {
  const ObjectModel model = model_of(cylinder_mesh(0.04F, 0.06F), 0.06, 0);
  const RigidTransform pose = standing(model, kTable, 300, 200, 0);
  int sides = 0;
  for (const EdgeSample& s : samples_of(model, pose)) {
    const Eigen::Vector3d p = pose.inverse() * s.point;
    if (std::abs(std::abs(p.z()) - 0.06) < 1e-4) continue;  // rims
    ++sides;
    EXPECT_EQ(s.origin, EdgeOrigin::kSilhouette);
  }
  EXPECT_GT(sides, 10);
}

TEST(ContourEdges, MarksShowOnTheSideThatFacesTheCamera) {
  ObjectModel model = model_of(box_mesh({0.08F, 0.05F, 0.1F}), 0.1, 180);
  model.marks = {{{0, -0.05F, 0}, {1, 0, 0}, {0, -1, 0}}, {{0, 0.05F, 0}, {1, 0, 0}, {0, 1, 0}}};
  const RigidTransform pose = standing(model, kTable, 320, 240, 0.0);
  std::vector<EdgeSample> marks;
  for (const EdgeSample& s : samples_of(model, pose)) {
    if (s.origin == EdgeOrigin::kMark) marks.push_back(s);
  }
  ASSERT_EQ(marks.size(), 1U);
  const Eigen::Vector3d along = pose.linear().col(0);
  const Eigen::Vector2d a = kCamera.project(marks[0].point + 0.001 * along) - marks[0].pixel;
  EXPECT_NEAR(marks[0].normal.dot(a.normalized()), 0, 0.01);
}

}  // namespace
}  // namespace sextant
