// SPDX-License-Identifier: Apache-2.0
#include "runtime/frame/search_frame.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "runtime/base/error.h"

namespace sextant {
namespace {

RgbdFrame plane_frame(const CameraModel& camera) {
  RgbdFrame f;
  f.camera = camera;
  f.colour = cv::Mat(camera.height, camera.width, CV_8UC3, cv::Scalar(10, 20, 30));
  f.axial_depth_m = cv::Mat(camera.height, camera.width, CV_32FC1, cv::Scalar(1.5));
  return f;
}

CameraModel camera(double fx, double fy, double k1) {
  CameraModel c;
  c.width = 320;
  c.height = 240;
  c.fx = fx;
  c.fy = fy;
  c.cx = 155;
  c.cy = 122;
  c.distortion[0] = k1;
  return c;
}

// A fronto-parallel plane at axial depth Z has ray depth Z / (z of the unit ray) whatever the lens.
TEST(Rectified, DepthRunsAlongTheRay) {
  for (const CameraModel& c : {camera(260, 260, 0), camera(260, 250, 0), camera(260, 262, 0.15)}) {
    const SearchFrame s = rectified(plane_frame(c));
    int checked = 0;
    for (int y = 10; y < 230; y += 11) {
      for (int x = 10; x < 310; x += 13) {
        const float d = s.ray_depth_m.at<float>(y, x);
        if (d == 0) continue;  // outside of the source image
        EXPECT_NEAR(d, 1.5 / s.camera.ray(x, y).z(), 1e-5);
        ++checked;
      }
    }
    EXPECT_GT(checked, 300);
  }
}

// A coloured dot drawn where the real camera sees a ray appears where the ideal camera sees it.
TEST(Rectified, MovesPixelsToTheIdealCamera) {
  const CameraModel c = camera(262, 250, 0.12);
  for (const Eigen::Vector2d& tangent : {Eigen::Vector2d(0.2, -0.1), Eigen::Vector2d(-0.4, 0.3)}) {
    RgbdFrame f = plane_frame(c);
    const Eigen::Vector2d at = c.distorted_pixel(tangent);
    f.colour(
         cv::Rect(static_cast<int>(std::lround(at.x())) - 1, static_cast<int>(std::lround(at.y())) - 1, 3, 3))
        .setTo(cv::Scalar(255, 255, 255));
    const SearchFrame s = rectified(f);
    const Eigen::Vector2d expected = s.camera.project({tangent.x(), tangent.y(), 1});
    double sx = 0;
    double sy = 0;
    double n = 0;
    for (int y = 0; y < s.camera.height; ++y) {
      for (int x = 0; x < s.camera.width; ++x) {
        const double w = s.colour.at<cv::Vec3b>(y, x)[0] - 10.0;
        sx += w * x;
        sy += w * y;
        n += w;
      }
    }
    EXPECT_NEAR(sx / n, expected.x(), 0.8);
    EXPECT_NEAR(sy / n, expected.y(), 0.8);
  }
}

TEST(Rectified, MissingAndNonFiniteDepthIsMissing) {
  RgbdFrame f = plane_frame(camera(260, 260, 0));
  f.axial_depth_m.at<float>(50, 60) = 0;
  f.axial_depth_m.at<float>(50, 61) = -1;
  f.axial_depth_m.at<float>(50, 62) = std::numeric_limits<float>::quiet_NaN();
  f.axial_depth_m.at<float>(50, 63) = std::numeric_limits<float>::infinity();
  const SearchFrame s = rectified(f);
  for (int x = 60; x < 64; ++x) EXPECT_EQ(s.ray_depth_m.at<float>(50, x), 0);
  EXPECT_GT(s.ray_depth_m.at<float>(50, 64), 1);
  EXPECT_EQ(f.axial_depth_m.at<float>(50, 64), 1.5F);  // the source is left alone
}

TEST(Rectified, RefusesFramesThatDoNotFitTogether) {
  RgbdFrame f = plane_frame(camera(260, 260, 0));
  f.axial_depth_m = f.axial_depth_m.colRange(0, 300);
  EXPECT_THROW(rectified(f), InputError);
  f = plane_frame(camera(260, 260, 0));
  f.colour = cv::Mat();
  EXPECT_THROW(rectified(f), InputError);
  f = plane_frame(camera(0, 260, 0));
  EXPECT_THROW(rectified(f), InputError);
}

}  // namespace
}  // namespace sextant
