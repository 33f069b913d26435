// SPDX-License-Identifier: Apache-2.0
#include "runtime/geometry/camera_model.h"

#include <gtest/gtest.h>

#include <limits>

#include "runtime/base/error.h"

namespace sextant {
namespace {

CameraModel distorted_camera() {
  CameraModel c;
  c.width = 640;
  c.height = 480;
  c.fx = 530;
  c.fy = 527;
  c.cx = 322;
  c.cy = 238;
  c.distortion = {0.12, -0.25, 0.001, -0.0015, 0.1, 0, 0, 0};
  return c;
}

TEST(CameraModel, DistortionAndItsInverseAgree) {
  const CameraModel c = distorted_camera();
  for (double x = 0; x < 640; x += 40) {
    for (double y = 0; y < 480; y += 40) {
      const Eigen::Vector2d back = c.distorted_pixel(c.undistorted_tangent(x, y));
      EXPECT_NEAR(back.x(), x, 1e-6);
      EXPECT_NEAR(back.y(), y, 1e-6);
    }
  }
}

TEST(CameraModel, HalvingTheSizeKeepsTheRays) {
  CameraModel c = distorted_camera();
  c.distortion = {};
  c.fy = c.fx;
  const PinholeCamera full = c.ideal();
  const PinholeCamera half = c.ideal(320);
  EXPECT_EQ(half.height, 240);
  // The corner shared by both images (top left of pixel 0, 0) is the same ray.
  EXPECT_TRUE(full.ray(-0.5, -0.5).isApprox(half.ray(-0.5, -0.5), 1e-12));
  EXPECT_TRUE(full.ray(639.5, 479.5).isApprox(half.ray(319.5, 239.5), 1e-12));
}

TEST(CameraModel, RefusesNonsense) {
  CameraModel c = distorted_camera();
  EXPECT_NO_THROW(c.check("camera"));
  c.fx = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(c.check("camera"), InputError);
  c = distorted_camera();
  c.width = 0;
  EXPECT_THROW(c.check("camera"), InputError);
  c = distorted_camera();
  c.cx = 5000;
  EXPECT_THROW(c.check("camera"), InputError);
  c = distorted_camera();
  c.distortion[2] = std::numeric_limits<double>::infinity();
  EXPECT_THROW(c.check("camera"), InputError);
}

}  // namespace
}  // namespace sextant
