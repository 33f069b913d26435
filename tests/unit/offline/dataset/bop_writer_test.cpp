// SPDX-License-Identifier: Apache-2.0
// What the writer writes, the reader of hal/playback reads back.
#include "offline/dataset/bop_writer.h"

#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <sstream>

#include "hal/playback/bop_dataset.h"
#include "runtime/base/error.h"
#include "tests/support/random_pose.h"
#include "tests/support/simple_objects.h"
#include "tests/support/temporary_folder.h"

namespace sextant {
namespace {

RgbdFrame small_frame(int seed) {
  RgbdFrame frame;
  frame.colour = cv::Mat(24, 32, CV_8UC3, cv::Scalar(seed, 2 * seed, 3));
  frame.axial_depth_m = cv::Mat(24, 32, CV_32FC1, cv::Scalar(0.5 + 0.0001 * seed));
  frame.axial_depth_m.at<float>(0, 0) = 0;
  frame.axial_depth_m.at<float>(0, 1) = 50;  // more than 16 bits of 0.1 mm
  frame.axial_depth_m.at<float>(0, 2) = std::nanf("");
  frame.camera.width = 32;
  frame.camera.height = 24;
  frame.camera.fx = 30.25;
  frame.camera.fy = 31;
  frame.camera.cx = 15.5;
  frame.camera.cy = 11.5;
  frame.table = TableGeometry::from_pitch_roll(0.7, -0.1, 0.83);
  return frame;
}

TEST(BopWriter, RoundTripsThroughTheReader) {
  const TemporaryFolder folder;
  std::mt19937_64 random(3);
  const RigidTransform pose = random_pose(random);
  BopInstance instance;
  instance.object_id = 12;
  instance.camera_from_mesh = pose;
  instance.bbox_object = {-3, 4, 20, 10};
  instance.bbox_visible = {0, 4, 10, 10};
  instance.pixels_all = 200;
  instance.pixels_valid = 100;
  instance.pixels_visible = 50;
  {
    BopWriter writer(folder.path());
    writer.add_image(1, 3, small_frame(3), {instance});
    writer.add_image(1, 20, small_frame(20), {});
    writer.add_image(7, 0, small_frame(40), {instance, instance});
    writer.finish();
  }
  const BopDataset dataset = open_bop_dataset(folder.path(), "test");
  ASSERT_EQ(3U, dataset.images.size());
  const BopImage& image = dataset.images[0];
  ASSERT_EQ(1U, image.ground_truth.size());
  EXPECT_EQ(12, image.ground_truth[0].object_id);
  EXPECT_TRUE(pose.isApprox(image.ground_truth[0].camera_from_mesh, 1e-12));
  EXPECT_EQ(0.25, image.ground_truth[0].visible_fraction);
  EXPECT_EQ(cv::Rect2d(-3, 4, 20, 10), image.ground_truth[0].bbox);
  EXPECT_TRUE(dataset.images[1].ground_truth.empty());
  EXPECT_EQ(2U, dataset.images[2].ground_truth.size());

  const RgbdFrame written = small_frame(3);
  const RgbdFrame read = load_frame(image);
  EXPECT_EQ(0, std::memcmp(written.colour.data, read.colour.data, written.colour.total() * 3));
  EXPECT_NEAR(written.axial_depth_m.at<float>(5, 5), read.axial_depth_m.at<float>(5, 5), 0.00005001);
  for (int x = 0; x < 3; ++x) EXPECT_EQ(0.0F, read.axial_depth_m.at<float>(0, x)) << x;
  EXPECT_EQ(written.camera.fx, read.camera.fx);
  EXPECT_EQ(written.camera.cy, read.camera.cy);
  ASSERT_TRUE(read.table.has_value());
  EXPECT_TRUE(written.table->up_in_camera.isApprox(read.table->up_in_camera, 1e-12));
  EXPECT_EQ(0.83, read.table->camera_height_m);
}

TEST(BopWriter, RefusesWhatTheLayoutCannotHold) {
  const TemporaryFolder folder;
  BopWriter writer(folder.path());
  RgbdFrame frame = small_frame(1);
  frame.camera.distortion[0] = 0.1;
  EXPECT_THROW(writer.add_image(1, 0, frame, {}), InputError);
  EXPECT_THROW(BopWriter("/proc/nowhere"), InputError);
}

TEST(BopWriter, ModelsAreInTheMeshesOwnFrameInMillimetres) {
  const TemporaryFolder folder;
  StandingObject object = box_object(0.03, 0.05, 0.07);
  std::mt19937_64 random(4);
  object.object_from_mesh = random_pose(random);
  cv::Mat texture(2, 2, CV_8UC3, cv::Scalar(255, 255, 255));
  texture.at<cv::Vec3b>(0, 0) = cv::Vec3b(10, 200, 100);  // top left: u < 0.5, v > 0.5
  object.mesh.textures.push_back(texture);
  object.mesh.parts[0].texture = 0;
  object.mesh.uvs[0] = Eigen::Vector2f(0.25F, 0.75F);
  object.mesh.colours[0] = Eigen::Vector3f(1, 0.5F, 1);
  {
    BopWriter writer(folder.path());
    writer.add_model(5, object);
    writer.finish();
  }
  std::stringstream content;
  content << std::ifstream(folder / "models/obj_000005.ply", std::ios::binary).rdbuf();
  const std::string text = content.str();
  const std::string end = "end_header\n";
  const std::size_t at = text.find(end) + end.size();
  EXPECT_EQ(24U * 27 + 12 * 13, text.size() - at);
  float first[3];
  std::memcpy(first, text.data() + at, sizeof(first));
  const Eigen::Vector3d expected =
      object.object_from_mesh.inverse() * object.mesh.vertices[0].cast<double>() * 1000;
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(expected[i], first[i], 1e-3);
  unsigned char colour[3];
  std::memcpy(colour, text.data() + at + 24, 3);
  EXPECT_EQ(10, colour[0]);
  EXPECT_EQ(100, colour[1]);
  EXPECT_EQ(100, colour[2]);
  EXPECT_EQ(1U, read_models_info(folder / "models/models_info.json").count(5));
}

}  // namespace
}  // namespace sextant
