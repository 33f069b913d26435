// SPDX-License-Identifier: Apache-2.0
#include "offline/report/overlay.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "tests/unit/offline/report/box_model.h"

namespace sextant {
namespace {

class Overlay : public testing::Test {
 protected:
  Overlay() {
    frame_.colour = cv::Mat(240, 320, CV_8UC3, cv::Scalar(90, 90, 90));
    frame_.axial_depth_m = cv::Mat::ones(240, 320, CV_32FC1);
    frame_.camera = test_camera();
    ObjectModel model;
    model.name = "box";
    model.object_id = 3;
    model.mesh = box_mesh(0.06F, 0.06F, 0.06F);
    model.bounding_radius_m = 0.104;
    // The mesh's own frame sits 5 cm to the right of the object's centre and is turned by 90 deg about z.
    model.object_from_mesh.linear() =
        Eigen::AngleAxisd(1.5707963267948966, Eigen::Vector3d::UnitZ()).matrix();
    model.object_from_mesh.translation() = Eigen::Vector3d(0.05, 0, 0);
    models_.push_back(model);
    estimate_.object_id = 3;
    estimate_.object_name = "box";
    estimate_.score = 0.91;
    estimate_.bbox = {10, 20, 30, 40};
  }
  /// The pose of the mesh's own frame for an object whose centre is 1 m straight ahead.
  void put_ahead() {
    const RigidTransform camera_from_object(Eigen::Translation3d(0, 0, 1.0));
    estimate_.camera_from_object = camera_from_object * models_[0].object_from_mesh;
    result_.estimates = {estimate_};
  }
  cv::Vec3b at(const cv::Mat& picture, double x, double y) const {
    const int scale = picture.cols / 320;
    return picture.at<cv::Vec3b>(static_cast<int>((y + 0.5) * scale), static_cast<int>((x + 0.5) * scale));
  }
  RgbdFrame frame_;
  FrameResult result_;
  std::vector<ObjectModel> models_;
  PoseEstimate estimate_;
};

TEST_F(Overlay, EnlargesAndLeavesTheRestOfThePictureAlone) {
  const cv::Mat picture = draw_overlay(frame_, result_, models_);
  EXPECT_EQ(cv::Size(1280, 960), picture.size());
  EXPECT_EQ(cv::Vec3b(90, 90, 90), picture.at<cv::Vec3b>(5, 5));
  cv::Mat large(1000, 2000, CV_8UC3, cv::Scalar(1, 2, 3));
  frame_.colour = large;
  EXPECT_EQ(large.size(), draw_overlay(frame_, result_, models_).size());
}

TEST_F(Overlay, OutlinesTheMeshWhereItIs) {
  put_ahead();
  const cv::Mat picture = draw_overlay(frame_, result_, models_);
  // Near face at 0.94 m: half side 19.15 pixels about (160, 120).
  const cv::Vec3b rim = at(picture, 160 - 19.15, 128);
  const cv::Vec3b inside = at(picture, 148, 130);
  EXPECT_GT(cv::norm(rim, cv::Vec3b(90, 90, 90)), 60);
  EXPECT_NE(cv::Vec3b(90, 90, 90), inside);
  EXPECT_LT(cv::norm(inside, cv::Vec3b(90, 90, 90)), 60) << "the object must stay visible";
  EXPECT_EQ(cv::Vec3b(90, 90, 90), at(picture, 250, 200));
}

TEST_F(Overlay, AxesAreThoseOfTheMeshFrame) {
  put_ahead();
  const cv::Mat picture = draw_overlay(frame_, result_, models_);
  // Its origin: 5 cm right of the centre = 15 pixels; x points down in the image (red), y to the left
  // (green).
  const cv::Vec3b x_axis = at(picture, 175, 120 + 12);
  EXPECT_GT(x_axis[0], x_axis[1] + 100);
  EXPECT_GT(x_axis[0], x_axis[2] + 100);
  const cv::Vec3b y_axis = at(picture, 175 - 12, 120);
  EXPECT_GT(y_axis[1], y_axis[0] + 100);
  EXPECT_GT(y_axis[1], y_axis[2] + 100);
}

TEST_F(Overlay, LabelsOfNeighboursDoNotCoverEachOther) {
  put_ahead();
  for (int i = 1; i < 4; ++i) {
    PoseEstimate other = estimate_;
    other.camera_from_object.pretranslate(Eigen::Vector3d(0.002 * i, 0, 0));
    result_.estimates.push_back(other);
  }
  result_.estimates[0].camera_from_object =
      RigidTransform(Eigen::Translation3d(0, 0, 1)) * models_[0].object_from_mesh;
  const cv::Mat one = [&] {
    FrameResult alone = result_;
    alone.estimates.resize(1);
    return draw_overlay(frame_, alone, models_);
  }();
  // Every label adds its own dark area.
  const auto dark = [](const cv::Mat& picture) {
    cv::Mat mask;
    cv::inRange(picture, cv::Scalar(25, 25, 25), cv::Scalar(42, 42, 46), mask);
    return cv::countNonZero(mask);
  };
  EXPECT_GT(dark(draw_overlay(frame_, result_, models_)), 3 * dark(one));
}

TEST_F(Overlay, ObjectsThatAreAbsentAreListed) {
  ObjectOutcome absent;
  absent.object_id = 3;
  absent.object_name = "box";
  absent.status = SearchStatus::kAbsent;
  result_.objects = {absent};
  const cv::Mat picture = draw_overlay(frame_, result_, models_);
  EXPECT_NE(cv::Vec3b(90, 90, 90), picture.at<cv::Vec3b>(930, 40));
  put_ahead();
  EXPECT_EQ(cv::Vec3b(90, 90, 90), draw_overlay(frame_, result_, models_).at<cv::Vec3b>(930, 40));
}

TEST_F(Overlay, AnswersThatCannotBeDrawnDoNotCrash) {
  put_ahead();
  result_.estimates.push_back(estimate_);
  result_.estimates.back().object_id = 77;  // no model: its box
  result_.estimates.push_back(estimate_);
  result_.estimates.back().camera_from_object.translation().z() = -1;
  result_.estimates.push_back(estimate_);
  result_.estimates.back().bbox = {1e300, -1e300, 5, 5};
  result_.estimates.back().object_id = 78;
  result_.estimates.back().object_name = std::string(500, '\xE4');
  EXPECT_EQ(cv::Size(1280, 960), draw_overlay(frame_, result_, models_).size());
}

}  // namespace
}  // namespace sextant
