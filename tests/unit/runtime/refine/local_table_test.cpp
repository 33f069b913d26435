// SPDX-License-Identifier: Apache-2.0
#include "runtime/refine/local_table.h"

#include <gtest/gtest.h>

#include "tests/unit/runtime/refine/refine_scene.h"

namespace sextant {
namespace {

using namespace test;

struct Fitted {
  LocalTable local;
  TableGeometry truth;
  Eigen::Vector3d foot{0, 0, 0};
  double stated_height_m = 0;
};

/// A box on a table whose stated plane is off by so much under the box, and tilted.
Fitted fit(double height_off_m, double pitch_off_deg, const std::string& sensor, bool depth = true) {
  const ObjectModel model = model_of(box_mesh({0.06F, 0.05F, 0.08F}), 0.08, 180);
  Fitted f;
  f.truth = TableGeometry::from_pitch_roll(40 * kDegree, 1 * kDegree, 0.6);
  const RigidTransform pose = standing(model, f.truth, 340, 230, 0.4);
  f.foot = pose.translation() - 0.08 * f.truth.up_in_camera;
  TableGeometry stated = TableGeometry::from_pitch_roll((40 + pitch_off_deg) * kDegree, 1 * kDegree, 0.6);
  stated.camera_height_m = height_off_m - stated.up_in_camera.dot(f.foot);
  f.stated_height_m = stated.camera_height_m;
  // Clutter on one side must not lift the table.
  const ModelMesh slab = box_mesh({0.05F, 0.05F, 0.02F});
  const ObjectModel slab_model = model_of(slab, 0.02, 90);
  Scene scene = make_scene({{&model.mesh, pose}, {&slab, standing(slab_model, f.truth, 470, 260, 0.2)}},
                           f.truth, sensor, 5);
  if (!depth) scene.frame.ray_depth_m.setTo(0);
  DepthRaster raster;
  raster.draw(model.mesh, pose, kCamera);
  f.local = local_table(scene.frame, stated, TableTolerance{}, raster, pose.translation());
  return f;
}

double height_error_m(const Fitted& f) {
  return f.local.table.up_in_camera.dot(f.foot) + f.local.table.camera_height_m;
}

TEST(LocalTable, CorrectsAWrongHeightAndPitch) {
  for (const auto& [height, pitch] : {std::pair{0.0, 0.0}, {0.01, 1.5}, {-0.012, -2.0}, {0.005, 3.0}}) {
    const Fitted f = fit(height, pitch, "kinect1");
    EXPECT_TRUE(f.local.fitted);
    EXPECT_LT(std::abs(height_error_m(f)), 0.004) << height << " m, " << pitch << " deg";
    const double tilt = std::acos(std::min(1.0, f.local.table.up_in_camera.dot(f.truth.up_in_camera)));
    EXPECT_LT(tilt / kDegree, 1.2) << height << " m, " << pitch << " deg";
    EXPECT_LT(std::abs(height_error_m(f)), 3 * f.local.height_sigma_m);
  }
}

TEST(LocalTable, IsExactWithoutNoise) {
  const Fitted f = fit(0.008, 1.0, "none");
  EXPECT_LT(std::abs(height_error_m(f)), 0.001);
}

TEST(LocalTable, WithoutDepthTheStatedTableStaysWithItsTolerance) {
  const Fitted f = fit(0.01, 1, "none", false);
  EXPECT_FALSE(f.local.fitted);
  EXPECT_DOUBLE_EQ(f.local.table.camera_height_m, f.stated_height_m);
  EXPECT_GE(f.local.height_sigma_m, 0.5 * TableTolerance{}.height_m);
  EXPECT_GE(f.local.tilt_sigma_rad, 0.5 * TableTolerance{}.angle_rad);
}

}  // namespace
}  // namespace sextant
