// SPDX-License-Identifier: Apache-2.0
#include "hal/playback/bop_dataset.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/real_data.h"
#include "tests/support/small_bop.h"
#include "tests/support/temporary_folder.h"

namespace sextant {
namespace {

TEST(BopDataset, ListsScenesAndImagesInNumericOrder) {
  const TemporaryFolder folder;
  write_small_bop(folder.path());
  // As text "2" comes after "000010".
  std::filesystem::rename(folder / "test/000001", folder / "test/2");
  const BopDataset dataset = open_bop_dataset(folder.path(), "test");
  std::vector<std::pair<int, int>> order;
  for (const BopImage& image : dataset.images) order.emplace_back(image.scene_id, image.image_id);
  EXPECT_THAT(order,
              testing::ElementsAre(std::pair(2, 2), std::pair(2, 11), std::pair(10, 2), std::pair(10, 11)));
  EXPECT_EQ(2U, open_bop_dataset(folder.path(), "test", 10).images.size());
}

TEST(BopDataset, ReadsCameraTableAndGroundTruth) {
  const TemporaryFolder folder;
  write_small_bop(folder.path());
  const BopDataset dataset = open_bop_dataset(folder.path(), "test");
  EXPECT_TRUE(dataset.has_ground_truth);
  const BopImage& image = dataset.images.at(0);
  EXPECT_EQ(30, image.camera.fx);
  EXPECT_EQ(31, image.camera.fy);
  EXPECT_EQ(15.5, image.camera.cx);
  EXPECT_EQ(11.5, image.camera.cy);
  ASSERT_TRUE(image.table.has_value());
  EXPECT_NEAR(0.7, image.table->pitch_rad(), 1e-12);
  EXPECT_NEAR(0.1, image.table->roll_rad(), 1e-12);
  EXPECT_EQ(0.6, image.table->camera_height_m);
  ASSERT_EQ(1U, image.ground_truth.size());
  const BopGt& gt = image.ground_truth[0];
  EXPECT_EQ(4, gt.object_id);
  EXPECT_TRUE(gt.camera_from_mesh.translation().isApprox(Eigen::Vector3d(0.01, -0.02, 0.9), 1e-12));
  // R row-wise: x of the mesh is y of the camera.
  EXPECT_TRUE(
      (gt.camera_from_mesh.linear() * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d::UnitY(), 1e-12));
  EXPECT_EQ(0.25, gt.visible_fraction);
  EXPECT_EQ(cv::Rect2d(3, 4, 5, 6), gt.bbox);

  const BopImage& other = dataset.images.at(1);
  EXPECT_FALSE(other.table.has_value());
  EXPECT_TRUE(other.ground_truth.empty());
}

TEST(BopDataset, LoadsColourAndDepthInMetres) {
  const TemporaryFolder folder;
  write_small_bop(folder.path());
  const BopDataset dataset = open_bop_dataset(folder.path(), "test");
  const RgbdFrame frame = load_frame(dataset.images.at(3));
  EXPECT_EQ(cv::Vec3b(10, 11, 7), frame.colour.at<cv::Vec3b>(0, 0));
  EXPECT_EQ(CV_32FC1, frame.axial_depth_m.type());
  EXPECT_EQ(0.0F, frame.axial_depth_m.at<float>(0, 0));
  EXPECT_FLOAT_EQ(0.5055F, frame.axial_depth_m.at<float>(5, 5));
  EXPECT_EQ(32, frame.camera.width);
  EXPECT_EQ(24, frame.camera.height);
  EXPECT_EQ(10, frame.scene_id);
  EXPECT_EQ(11, frame.image_id);
}

TEST(BopDataset, OptionalListsMayBeAbsentAndGreyStandsInForColour) {
  const TemporaryFolder folder;
  write_small_bop(folder.path());
  for (const char* file : {"scene_gt.json", "scene_gt_info.json", "scene_table.json"}) {
    std::filesystem::remove(folder / "test/000001" / file);
  }
  std::filesystem::rename(folder / "test/000001/rgb", folder / "test/000001/gray");
  const BopDataset dataset = open_bop_dataset(folder.path(), "test", 1);
  EXPECT_FALSE(dataset.has_ground_truth);
  EXPECT_FALSE(dataset.images.at(0).table.has_value());
  EXPECT_EQ(cv::Vec3b(1, 2, 7), load_frame(dataset.images.at(0)).colour.at<cv::Vec3b>(0, 0));
}

TEST(BopDataset, ReadsTheRealSets) {
  SEXTANT_NEEDS_REAL_DATA(kinect, "mosd_kinect_parametric");
  SEXTANT_NEEDS_REAL_DATA(ycb, "ycbv_samples");
  EXPECT_EQ(21U, open_bop_dataset(kinect, "test").images.size());
  const BopDataset dataset = open_bop_dataset(ycb, "test");
  ASSERT_EQ(5U, dataset.images.size());
  for (const BopImage& image : dataset.images) {
    const RgbdFrame frame = load_frame(image);
    EXPECT_EQ(cv::Size(640, 480), frame.colour.size());
    ASSERT_TRUE(frame.table.has_value());
    ASSERT_FALSE(image.ground_truth.empty());
    for (const BopGt& gt : image.ground_truth) {
      // The depth at the object's projected origin is near the object (which is smaller than 15 cm there).
      const Eigen::Vector3d p = gt.camera_from_mesh.translation();
      const int x = static_cast<int>(std::lround(frame.camera.cx + frame.camera.fx * p.x() / p.z()));
      const int y = static_cast<int>(std::lround(frame.camera.cy + frame.camera.fy * p.y() / p.z()));
      if (x < 0 || y < 0 || x >= 640 || y >= 480) continue;
      const float depth = frame.axial_depth_m.at<float>(y, x);
      if (depth <= 0) continue;
      EXPECT_NEAR(depth, p.z(), 0.25) << "scene " << image.scene_id << " object " << gt.object_id;
    }
  }
}

}  // namespace
}  // namespace sextant
