// SPDX-License-Identifier: Apache-2.0
// What one rank writes, another reads: nothing is lost, and a short message is noticed.
#include <gtest/gtest.h>

#include "offline/mpi/detect_wire.h"
#include "offline/mpi/frame_wire.h"

namespace sextant {
namespace {

/// No field has its default value.
DetectOptions unusual_options() {
  DetectOptions o;
  o.table = TableSource::kFixed;
  o.fixed_table = TableGeometry{{0.1, -0.8, -0.59}, 0.71};
  o.tolerance = {0.02, 0.1};
  o.max_detections = 7;
  o.threshold = 12.5;
  o.scoring = "thesis";
  o.search_width = 320;
  o.min_distance_m = 0.4;
  o.max_distance_m = 2.5;
  o.region = region_from_text("1 2 30 40", "-1 1 -2 2 0 0.5", "0.1 0.2 0.3 0 0 0.6 0.8");
  o.runner_up = false;
  o.runner_up_radius_m = 0.05;
  o.runner_up_angle_rad = 0.3;
  o.runner_up_most = 11;
  return o;
}

void expect_same(const DetectOptions& a, const DetectOptions& b) {
  EXPECT_EQ(a.table, b.table);
  EXPECT_EQ(a.fixed_table.up_in_camera, b.fixed_table.up_in_camera);
  EXPECT_EQ(a.fixed_table.camera_height_m, b.fixed_table.camera_height_m);
  EXPECT_EQ(a.tolerance.height_m, b.tolerance.height_m);
  EXPECT_EQ(a.tolerance.angle_rad, b.tolerance.angle_rad);
  EXPECT_EQ(a.max_detections, b.max_detections);
  EXPECT_EQ(a.threshold, b.threshold);
  EXPECT_EQ(a.scoring, b.scoring);
  EXPECT_EQ(a.search_width, b.search_width);
  EXPECT_EQ(a.min_distance_m, b.min_distance_m);
  EXPECT_EQ(a.max_distance_m, b.max_distance_m);
  EXPECT_TRUE(a.region == b.region);
  EXPECT_EQ(a.runner_up, b.runner_up);
  EXPECT_EQ(a.runner_up_radius_m, b.runner_up_radius_m);
  EXPECT_EQ(a.runner_up_angle_rad, b.runner_up_angle_rad);
  EXPECT_EQ(a.runner_up_most, b.runner_up_most);
}

TEST(MpiWire, OptionsArriveAsTheyAre) {
  for (const DetectOptions& options : {DetectOptions{}, unusual_options()}) {
    Bytes bytes;
    append_options(bytes, options);
    ByteReader reader(bytes);
    expect_same(take_options(reader), options);
    EXPECT_EQ(reader.left(), 0U);
  }
}

TEST(MpiWire, ACallIsAboutTheModelsInTheirOrder) {
  std::vector<ObjectModel> models(3);
  models[0].name = "box";
  models[1].name = "mug";
  models[2].name = "can";
  DetectCall call;
  call.wanted = [](const std::string& name) { return name != "mug"; };
  call.thresholds = {{"can", -3.5}};
  call.image_region = {1, 2, 3, 4};
  Bytes bytes;
  append_call(bytes, call, models);
  ByteReader reader(bytes);
  const DetectCall back = take_call(reader, models);
  EXPECT_EQ(reader.left(), 0U);
  EXPECT_TRUE(back.wanted("box"));
  EXPECT_FALSE(back.wanted("mug"));
  EXPECT_TRUE(back.wanted("can"));
  EXPECT_EQ(back.thresholds, call.thresholds);
  EXPECT_EQ(back.image_region, call.image_region);

  bytes.clear();
  append_call(bytes, {}, models);
  ByteReader plain(bytes);
  const DetectCall all = take_call(plain, models);
  EXPECT_TRUE(all.wanted("mug"));
  EXPECT_TRUE(all.thresholds.empty());
  EXPECT_FALSE(all.image_region.has_value());
}

TEST(MpiWire, AFrameArrivesWithEveryPixel) {
  RgbdFrame frame;
  frame.camera.width = 5;
  frame.camera.height = 3;
  frame.camera.fx = 500;
  frame.camera.distortion[1] = 0.25;
  frame.table = TableGeometry{{0, -0.6, -0.8}, 0.9};
  frame.table_uncertainty = TableUncertainty{0.001, 0.002, 0.003, 0.004, 0.005};
  frame.scene_id = 4;
  frame.image_id = 5;
  frame.sequence = 6;
  frame.colour = cv::Mat(3, 5, CV_8UC3);
  frame.axial_depth_m = cv::Mat(3, 5, CV_32FC1);
  for (int y = 0; y < 3; ++y) {
    for (int x = 0; x < 5; ++x) {
      frame.colour.at<cv::Vec3b>(y, x) =
          cv::Vec3b(static_cast<std::uint8_t>(x), static_cast<std::uint8_t>(y), 7);
      frame.axial_depth_m.at<float>(y, x) = 0.5F + static_cast<float>(x) * 0.1F;
    }
  }
  Bytes bytes;
  append_frame(bytes, frame);
  ByteReader reader(bytes);
  const RgbdFrame back = take_frame(reader);
  EXPECT_EQ(reader.left(), 0U);
  EXPECT_EQ(cv::norm(back.colour, frame.colour, cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(back.axial_depth_m, frame.axial_depth_m, cv::NORM_INF), 0);
  EXPECT_EQ(back.camera.fx, 500);
  EXPECT_EQ(back.camera.distortion, frame.camera.distortion);
  EXPECT_EQ(back.table->camera_height_m, 0.9);
  EXPECT_EQ(back.table_uncertainty->surface_m, 0.005);
  EXPECT_EQ(back.sequence, 6);

  bytes.resize(bytes.size() - 1);
  ByteReader cut(bytes);
  EXPECT_THROW(take_frame(cut), std::logic_error);
}

}  // namespace
}  // namespace sextant
