// SPDX-License-Identifier: Apache-2.0
#include "runtime/daemon/annotate.h"

#include <gtest/gtest.h>

namespace sextant {
namespace {

TEST(Annotate, DrawsTheOutlineWhereTheObjectIsAndLeavesTheFrameAlone) {
  RgbdFrame frame;
  frame.colour = cv::Mat(120, 160, CV_8UC3, cv::Scalar(40, 40, 40));
  frame.camera.width = 160;
  frame.camera.height = 120;
  frame.camera.fx = frame.camera.fy = 150;
  frame.camera.cx = 80;
  frame.camera.cy = 60;
  FrameResult result;
  PoseEstimate estimate;
  estimate.object_name = "plate";
  estimate.camera_from_object.translation() = Eigen::Vector3d(0, 0, 1);
  estimate.score = 1;  // green
  result.estimates.push_back(estimate);
  // A square of 0.2 m, seen from the front: 30 x 30 pixels around (80, 60).
  ObjectShapes shapes;
  const Eigen::Vector3f a(-0.1F, -0.1F, 0), b(0.1F, -0.1F, 0), c(0.1F, 0.1F, 0), d(-0.1F, 0.1F, 0);
  shapes["plate"].corners = {a, b, c, a, c, d};

  const cv::Mat image = annotate(frame, result, shapes);
  EXPECT_EQ(image.size(), frame.colour.size());
  const cv::Vec3b edge = image.at<cv::Vec3b>(60, 95);  // right side of the square
  EXPECT_GT(edge[1], 150);
  EXPECT_LT(edge[0], 100);
  EXPECT_EQ(image.at<cv::Vec3b>(70, 72), cv::Vec3b(40, 40, 40));    // inside
  EXPECT_EQ(image.at<cv::Vec3b>(110, 150), cv::Vec3b(40, 40, 40));  // far away
  EXPECT_EQ(cv::countNonZero(frame.colour.reshape(1) != 40), 0);

  // Behind the camera and absurd poses draw nothing and harm nobody.
  result.estimates[0].camera_from_object.translation().z() = -1;
  EXPECT_NO_THROW(annotate(frame, result, shapes));
  result.estimates[0].camera_from_object.translation() = Eigen::Vector3d(1e9, 0, 1e-2);
  EXPECT_NO_THROW(annotate(frame, result, shapes));
}

}  // namespace
}  // namespace sextant
