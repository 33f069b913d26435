// SPDX-License-Identifier: Apache-2.0
// A camera driver on Fast DDS drives the real sextantd, and its poses come back to Fast DDS: no Cyclone DDS
// on the other side at either end.
#include <gmock/gmock.h>

#include <fstream>
#include <opencv2/core.hpp>

#include "runtime/model/model_file.h"
#include "tests/integration/child_process.h"
#include "tests/interop/fast_dds_peer.h"
#include "tests/interop/msg_codec.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/runtime/model/synthetic_model.h"
#include "tests/unit/runtime/publish/dds_test_domain.h"

namespace sextant {
namespace {

using Json = nlohmann::json;

constexpr int kWidth = 96, kHeight = 72;

Json header_at(std::int64_t nanoseconds) {
  return {{"stamp", {{"sec", nanoseconds / 1'000'000'000}, {"nanosec", nanoseconds % 1'000'000'000}}},
          {"frame_id", "fast_camera"}};
}

Json image(const cv::Mat& pixels, const std::string& encoding, std::int64_t nanoseconds) {
  const std::size_t bytes = pixels.total() * pixels.elemSize();
  const auto* begin = pixels.ptr<std::uint8_t>();
  return {{"header", header_at(nanoseconds)},
          {"height", kHeight},
          {"width", kWidth},
          {"encoding", encoding},
          {"step", static_cast<int>(pixels.step)},
          {"data", Json::binary({begin, begin + bytes})}};
}

Json camera_info(std::int64_t nanoseconds) {
  const Json k = {90.0, 0.0, (kWidth - 1) / 2.0, 0.0, 90.0, (kHeight - 1) / 2.0, 0.0, 0.0, 1.0};
  return {
      {"header", header_at(nanoseconds)},
      {"height", kHeight},
      {"width", kWidth},
      {"distortion_model", "plumb_bob"},
      {"d", {0.0, 0.0, 0.0, 0.0, 0.0}},
      {"k", k},
      {"r", {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0}},
      {"p", {90.0, 0.0, (kWidth - 1) / 2.0, 0.0, 0.0, 90.0, (kHeight - 1) / 2.0, 0.0, 0.0, 0.0, 1.0, 0.0}}};
}

TEST(FastDdsCamera, DrivesADetection) {
  const DdsTestDomain domain;
  const TemporaryFolder folder;
  ObjectModel model = test::make_box_model(1, 12, 3);
  model.name = "box";
  write_model(model, folder / "box.sxm");
  const std::string space = domain.name_space;
  std::ofstream(folder / "sextantd.yaml")
      << "source: {kind: dds, frame_id: fast_camera}\ncolour: {topic: " << space
      << "/colour/image_raw}\ndepth: {topic: " << space << "/depth/image_raw}\nmodels: {files: [box.sxm]}\n"
      << "detect: {table: fixed, table_pitch_deg: 40, table_height_m: 0.7, threads: 1, threshold: -1e9, "
         "bound: window}\n"
      << "publish: {domain: " << domain.writing << ", namespace: " << space
      << "}\npipeline: {max_age_ms: 60000}\n";
  ChildProcess daemon({SEXTANTD, "--config", (folder / "sextantd.yaml").string()}, folder.path());

  MsgCodec codec(SEXTANT_SOURCE_DIR "/idl/msg");
  FastDdsPeer peer(domain.writing);
  const auto name = [&](const std::string& topic) { return "rt/" + space + "/" + topic; };
  FastDdsQos sensor;  // as a camera driver offers
  sensor.reliable = false;
  sensor.depth = 5;
  for (const char* stream : {"colour", "depth"}) {
    peer.advertise(name(std::string(stream) + "/image_raw"), MsgCodec::dds_type_name("sensor_msgs/Image"),
                   sensor);
    peer.advertise(name(std::string(stream) + "/camera_info"),
                   MsgCodec::dds_type_name("sensor_msgs/CameraInfo"), sensor);
  }
  peer.subscribe(name("pose_estimates"), MsgCodec::dds_type_name("sextant_msgs/PoseEstimateArray"));

  cv::Mat colour(kHeight, kWidth, CV_8UC3);
  cv::RNG(7).fill(colour, cv::RNG::UNIFORM, 0, 255);
  const cv::Mat depth(kHeight, kWidth, CV_16UC1, cv::Scalar(800));
  std::vector<std::int64_t> sent;
  std::optional<FastDdsPeer::Bytes> answer;
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(40);
  while (!answer && daemon.running() && std::chrono::steady_clock::now() < end) {
    const std::int64_t now = std::chrono::system_clock::now().time_since_epoch().count();
    sent.push_back(now);
    const auto info = codec.encode("sensor_msgs/CameraInfo", camera_info(now));
    for (const char* stream : {"colour", "depth"})
      peer.publish(name(std::string(stream) + "/camera_info"), info);
    peer.publish(name("colour/image_raw"), codec.encode("sensor_msgs/Image", image(colour, "rgb8", now)));
    peer.publish(name("depth/image_raw"), codec.encode("sensor_msgs/Image", image(depth, "16UC1", now)));
    answer = peer.take(name("pose_estimates"), std::chrono::milliseconds(100));
  }
  ASSERT_TRUE(answer.has_value()) << daemon.output("stderr");
  const Json json = codec.decode("sextant_msgs/PoseEstimateArray", *answer);
  ASSERT_EQ(json["estimates"].size(), 1U) << json.dump();
  EXPECT_EQ(json["estimates"][0]["object_name"], "box");
  EXPECT_EQ(json["header"]["frame_id"], "fast_camera");
  const std::int64_t stamp = json["header"]["stamp"]["sec"].get<std::int64_t>() * 1'000'000'000 +
                             json["header"]["stamp"]["nanosec"].get<std::int64_t>();
  EXPECT_THAT(sent, testing::Contains(stamp));  // the capture time of one of our images, to the nanosecond
  daemon.send(SIGTERM);
  EXPECT_EQ(daemon.wait(), 0) << daemon.output("stderr");
}

}  // namespace
}  // namespace sextant
