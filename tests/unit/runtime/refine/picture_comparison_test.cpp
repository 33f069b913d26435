// SPDX-License-Identifier: Apache-2.0
#include "runtime/refine/picture_comparison.h"

#include <gtest/gtest.h>

#include <cmath>

#include "runtime/geometry/pose_mapping.h"
#include "tests/unit/runtime/refine/refine_scene.h"

namespace sextant {
namespace {

using namespace test;

constexpr double kHalfHeight = 0.045;

/// A cylinder with a handle at +x, as a mug is.
ModelMesh mug() {
  ModelMesh all = cylinder_mesh(0.04F, static_cast<float>(kHalfHeight));
  const ModelMesh handle = box_mesh({0.02F, 0.006F, 0.03F});
  const auto base = static_cast<std::uint32_t>(all.vertices.size());
  for (const auto& v : handle.vertices) all.vertices.emplace_back(v + Eigen::Vector3f(0.055F, 0, 0));
  for (const auto& t : handle.triangles) all.triangles.push_back({base + t[0], base + t[1], base + t[2]});
  return all;
}

class PictureComparison : public testing::Test {
 protected:
  PictureComparison() {
    frame_.camera = {320, 240, 300, 159.5, 119.5};
    frame_.ray_depth_m = cv::Mat::zeros(240, 320, CV_32FC1);
  }

  /// Standing on the table, the handle turned by so much.
  RigidTransform standing(double turn_deg) const {
    const UprightPose up = upright_pose_at(frame_.camera, table_.up_in_camera, 170, 130);
    const double z = (table_.camera_height_m - kHalfHeight) / up.sine_of_elevation;
    return transform_from_pose(frame_.camera, {170, 130, z, up.rx, up.ry, turn_deg * std::numbers::pi / 180});
  }

  /// What a perfect sensor measures of the mug at `pose` and the table.
  void measure(const RigidTransform& pose) {
    raster_.draw(mesh_, pose, frame_.camera);
    for (int y = 0; y < 240; ++y) {
      for (int x = 0; x < 320; ++x) {
        const Eigen::Vector2d t = frame_.camera.tangent(x, y);
        const Eigen::Vector3d ray(t.x(), t.y(), 1);
        const double table = -table_.camera_height_m / table_.up_in_camera.dot(ray) * ray.norm();
        const float inverse = raster_.inverse_depth(x, y);
        frame_.ray_depth_m.at<float>(y, x) =
            static_cast<float>(inverse > 0 ? ray.norm() / static_cast<double>(inverse) : table);
      }
    }
  }

  double better(double first_deg, double second_deg, bool with_table = true) {
    DepthRaster first, second;
    first.draw(mesh_, standing(first_deg), frame_.camera);
    second.draw(mesh_, standing(second_deg), frame_.camera);
    return explained_better(frame_, with_table ? std::optional(table_) : std::nullopt, first, second);
  }

  const ModelMesh mesh_ = mug();
  const TableGeometry table_ = TableGeometry::from_pitch_roll(40 * std::numbers::pi / 180, 0, 0.45);
  SearchFrame frame_;
  DepthRaster raster_;
};

TEST_F(PictureComparison, TheHandleTellsTheTurn) {
  for (int truth = 0; truth < 360; truth += 30) {
    measure(standing(truth));
    for (int other = 40; other <= 320; other += 40) {
      EXPECT_GT(better(truth + other, truth), 0.1) << truth << " " << other;
      EXPECT_LT(better(truth, truth + other), -0.1) << truth << " " << other;
    }
  }
}

TEST_F(PictureComparison, TheSamePoseIsNoBetter) {
  measure(standing(0));
  EXPECT_EQ(better(0, 0), 0);
  EXPECT_EQ(better(90, 90), 0);
}

TEST_F(PictureComparison, WithoutDepthNothingIsKnown) {
  frame_.ray_depth_m.setTo(0);
  EXPECT_EQ(better(0, 90), 0);
}

TEST_F(PictureComparison, WithoutATableWhatIsBesideTheObjectSaysNothing) {
  measure(standing(0));
  EXPECT_GT(better(90, 0), 0.1);
  EXPECT_EQ(better(180, 0, false), 0);
}

}  // namespace
}  // namespace sextant
