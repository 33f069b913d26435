// SPDX-License-Identifier: Apache-2.0
#include "offline/report/silhouette.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>
#include <random>

#include "tests/unit/offline/report/box_model.h"

namespace sextant {
namespace {

TEST(Silhouette, OfAFrontalBoxIsItsNearFace) {
  const CameraModel camera = test_camera();
  RigidTransform pose = RigidTransform::Identity();
  pose.translation() = Eigen::Vector3d(0, 0, 1.0);
  // Near face at 0.9 m: half width 0.06 -> 20 pixels, half height 0.03 -> 10 pixels.
  for (const int scale : {1, 2, 3}) {
    const cv::Mat mask = silhouette_mask(box_mesh(0.06F, 0.03F, 0.1F), camera, pose, scale);
    ASSERT_EQ(cv::Size(320 * scale, 240 * scale), mask.size());
    const cv::Rect box = cv::boundingRect(mask);
    EXPECT_NEAR(40 * scale, box.width, 2);
    EXPECT_NEAR(20 * scale, box.height, 2);
    EXPECT_NEAR((160.5 - 20) * scale, box.x, 1);
    EXPECT_EQ(cv::countNonZero(mask), box.area());
  }
}

// Against a ray caster: a pixel is inside where the ray of its centre meets the sphere's polyhedron.
TEST(Silhouette, ContainsTheProjectionOfEveryInnerPoint) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  CameraModel camera = test_camera();
  camera.distortion = {0.05, -0.02, 0.001, -0.002, 0.01};
  camera.fy = 310;
  for (int i = 0; i < 100; ++i) {
    RigidTransform pose = RigidTransform::Identity();
    pose.linear() =
        Eigen::Quaterniond(unit(random), unit(random), unit(random), unit(random)).normalized().matrix();
    pose.translation() = Eigen::Vector3d(0.15 * unit(random), 0.1 * unit(random), 0.8);
    const Eigen::Vector3f half(0.08F, 0.05F, 0.03F);
    const cv::Mat mask = silhouette_mask(box_mesh(half.x(), half.y(), half.z()), camera, pose);
    for (int k = 0; k < 200; ++k) {
      const Eigen::Vector3d inside(0.99 * half.x() * unit(random), 0.99 * half.y() * unit(random),
                                   0.99 * half.z() * unit(random));
      const auto pixel = project_scaled(camera, pose * inside, 1);
      ASSERT_TRUE(pixel.has_value());
      const cv::Point p(static_cast<int>(std::lround(pixel->x)), static_cast<int>(std::lround(pixel->y)));
      if (!cv::Rect(0, 0, 320, 240).contains(p)) continue;
      // A point may be up to half a pixel outside of the filled pixels at the rim.
      const cv::Rect around = cv::Rect(p.x - 1, p.y - 1, 3, 3) & cv::Rect(0, 0, 320, 240);
      EXPECT_GT(cv::countNonZero(mask(around)), 0) << p;
    }
  }
}

TEST(Silhouette, PosesBehindOrAcrossTheCameraDrawNothingWrong) {
  RigidTransform pose = RigidTransform::Identity();
  pose.translation() = Eigen::Vector3d(0, 0, -1);
  EXPECT_EQ(0, cv::countNonZero(silhouette_mask(box_mesh(0.1F, 0.1F, 0.1F), test_camera(), pose)));
  pose.translation() = Eigen::Vector3d(1e9, 0, 0.03);
  EXPECT_EQ(0, cv::countNonZero(silhouette_mask(box_mesh(0.001F, 0.001F, 0.001F), test_camera(), pose)));
  pose.translation() = Eigen::Vector3d(0, 0, std::nan(""));
  EXPECT_EQ(0, cv::countNonZero(silhouette_mask(box_mesh(0.1F, 0.1F, 0.1F), test_camera(), pose)));
  ModelMesh broken = box_mesh(1, 1, 1);
  broken.triangles.push_back({0, 1, 8});
  EXPECT_THROW(silhouette_mask(broken, test_camera(), RigidTransform(Eigen::Translation3d(0, 0, 5))),
               std::invalid_argument);
}

}  // namespace
}  // namespace sextant
