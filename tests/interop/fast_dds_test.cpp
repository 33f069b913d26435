// SPDX-License-Identifier: Apache-2.0
// Fast DDS as an independent subscriber and publisher: every type arrives with its content, decoded by the
// .msg files alone; quality of service and type hashes are announced as documented; commands come from a
// stranger.
#include <gmock/gmock.h>

#include <cmath>
#include <numeric>
#include <thread>

#include "runtime/publish/command_server.h"
#include "runtime/publish/message_types.h"
#include "runtime/publish/publisher.h"
#include "tests/interop/fast_dds_peer.h"
#include "tests/interop/msg_codec.h"
#include "tests/unit/runtime/publish/dds_test_domain.h"
#include "tests/unit/runtime/publish/example_result.h"
#include "tests/unit/runtime/publish/raw_reader.h"

namespace sextant {
namespace {

using Json = nlohmann::json;
using std::chrono::milliseconds;
using std::chrono::seconds;

/// A publisher of ours and a stranger in one domain.
class Interop : public testing::Test {
 protected:
  Interop() : peer_(domain_.writing) {}

  PublisherOptions options() const {
    PublisherOptions o;
    o.domain = domain_.writing;
    o.name_space = domain_.name_space;
    o.max_age_ms = 60000;
    o.lease_ms = 400;
    o.object_shapes["object_0"] = {{0, 0, 0}, {0.1, 0.2, 0.3}, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
    return o;
  }
  std::string topic(const std::string& name) const { return "rt/" + domain_.name_space + "/" + name; }
  void subscribe(const std::string& name, const std::string& type, const FastDdsQos& qos = {}) {
    peer_.subscribe(topic(name), MsgCodec::dds_type_name(type), qos);
    ASSERT_TRUE(eventually([&] { return peer_.matched_writers(topic(name)) > 0; })) << name;
  }
  Json take(const std::string& name, const std::string& type) {
    const auto bytes = peer_.take(topic(name), seconds(20));
    if (!bytes) {
      ADD_FAILURE() << "nothing came on " << name;
      return {};
    }
    return codec_.decode(type, *bytes);
  }

  DdsTestDomain domain_;
  MsgCodec codec_{SEXTANT_SOURCE_DIR "/idl/msg"};
  FastDdsPeer peer_;
};

void expect_header(const Json& header, const FrameResult& sent) {
  EXPECT_EQ(header["stamp"]["sec"].get<std::int64_t>() * 1'000'000'000 +
                header["stamp"]["nanosec"].get<std::int64_t>(),
            sent.captured_at.time_since_epoch().count());
  EXPECT_EQ(header["frame_id"], sent.frame_id);
}

void expect_pose(const Json& pose, const RigidTransform& sent) {
  const Json& q = pose["orientation"];
  const Json& p = pose["position"];
  const Eigen::Matrix3d rotation = Eigen::Quaterniond(q["w"], q["x"], q["y"], q["z"]).toRotationMatrix();
  EXPECT_LT((rotation - sent.linear()).norm(), 1e-9);
  EXPECT_LT((Eigen::Vector3d(p["x"], p["y"], p["z"]) - sent.translation()).norm(), 1e-12);
}

TEST_F(Interop, EveryPublishedTypeArrivesWithItsContent) {
  Publisher publisher(options());
  subscribe("pose_estimates", "sextant_msgs/PoseEstimateArray");
  subscribe("detections", "vision_msgs/Detection3DArray");
  subscribe("object_pose", "geometry_msgs/PoseStamped");
  subscribe("tf", "tf2_msgs/TFMessage");
  subscribe("table_estimate", "sextant_msgs/TableEstimate");
  subscribe("markers", "visualization_msgs/MarkerArray");
  subscribe("annotated/image_raw", "sensor_msgs/Image");
  subscribe("diagnostics", "diagnostic_msgs/DiagnosticArray");
  ASSERT_TRUE(eventually([&] { return publisher.matched_readers() == 8; }));
  FrameResult sent = random_result(5, 3);
  sent.estimates[0].score = 1;
  publisher.publish(sent, 0.25);

  const Json native = take("pose_estimates", "sextant_msgs/PoseEstimateArray");
  expect_header(native["header"], sent);
  EXPECT_EQ(native["frame_number"], sent.sequence);
  EXPECT_EQ(native["nodes"], sent.nodes);
  EXPECT_NEAR(native["age_s"].get<double>(), 0.25, 1e-9);
  ASSERT_EQ(native["estimates"].size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    const Json& e = native["estimates"][i];
    const PoseEstimate& s = sent.estimates[i];
    EXPECT_EQ(e["object_id"], s.object_id);
    EXPECT_EQ(e["object_name"], s.object_name);
    expect_pose(e["pose"]["pose"], s.camera_from_object);
    for (std::size_t k = 0; k < 36; ++k)
      EXPECT_EQ(e["pose"]["covariance"][k], s.covariance(static_cast<int>(k / 6), static_cast<int>(k % 6)));
    EXPECT_EQ(e["score"], s.score);
    EXPECT_EQ(e["log_score"], s.log_score);
    EXPECT_EQ(e["upper_bound"], s.upper_bound);
    EXPECT_EQ(e["gap"], s.gap);
    EXPECT_EQ(e["runner_up_margin"], s.runner_up_margin);
    EXPECT_EQ(e["status"], static_cast<int>(s.status));
    EXPECT_EQ(e["bbox"], Json(s.bbox));
  }
  ASSERT_EQ(native["objects"].size(), sent.objects.size());
  EXPECT_EQ(native["objects"][3]["object_name"], "missing");
  EXPECT_EQ(native["objects"][3]["status"], 2);
  EXPECT_EQ(native["objects"][3]["upper_bound"], -30.25);

  const Json detections = take("detections", "vision_msgs/Detection3DArray");
  expect_header(detections["header"], sent);
  ASSERT_EQ(detections["detections"].size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    const Json& d = detections["detections"][i];
    EXPECT_EQ(d["id"], std::to_string(sent.estimates[i].object_id));
    EXPECT_EQ(d["results"][0]["hypothesis"]["class_id"], sent.estimates[i].object_name);
    EXPECT_EQ(d["results"][0]["hypothesis"]["score"], sent.estimates[i].score);
    expect_pose(d["results"][0]["pose"]["pose"], sent.estimates[i].camera_from_object);
  }
  EXPECT_EQ(detections["detections"][0]["bbox"]["size"]["y"], 0.2);

  const Json best = take("object_pose", "geometry_msgs/PoseStamped");
  expect_header(best["header"], sent);
  expect_pose(best["pose"], sent.estimates[0].camera_from_object);

  const Json tf = take("tf", "tf2_msgs/TFMessage");
  ASSERT_EQ(tf["transforms"].size(), 3U);
  EXPECT_EQ(tf["transforms"][1]["child_frame_id"], "object_1");
  expect_pose({{"position", tf["transforms"][1]["transform"]["translation"]},
               {"orientation", tf["transforms"][1]["transform"]["rotation"]}},
              sent.estimates[1].camera_from_object);

  const Json table = take("table_estimate", "sextant_msgs/TableEstimate");
  EXPECT_EQ(table["camera_height_m"], 0.75);
  EXPECT_EQ(table["source"], 1);
  EXPECT_NEAR(table["up_in_camera"]["z"].get<double>(), sent.table->up_in_camera.z(), 1e-12);

  const Json markers = take("markers", "visualization_msgs/MarkerArray");
  ASSERT_EQ(markers["markers"].size(), 1U + 3 * 2 + 1);  // only object_0 has a shape
  EXPECT_EQ(markers["markers"][0]["action"], 3);
  EXPECT_EQ(markers["markers"][1]["type"], 11);
  EXPECT_EQ(markers["markers"][1]["points"][1]["x"], 1.0);
  expect_pose(markers["markers"][1]["pose"], sent.estimates[0].camera_from_object);
  EXPECT_EQ(markers["markers"][2]["colors"].size(), 6U);

  cv::Mat picture(480, 640, CV_8UC3);
  cv::RNG(1).fill(picture, cv::RNG::UNIFORM, 0, 255);
  publisher.publish_annotated(sent, picture);
  const Json image = take("annotated/image_raw", "sensor_msgs/Image");
  expect_header(image["header"], sent);
  EXPECT_EQ(image["width"], 640);
  EXPECT_EQ(image["height"], 480);
  EXPECT_EQ(image["step"], 1920);
  EXPECT_EQ(image["encoding"], "rgb8");
  const auto& pixels = image["data"].get_binary();
  ASSERT_EQ(pixels.size(), 480U * 1920);
  EXPECT_TRUE(std::equal(pixels.begin(), pixels.end(), picture.ptr()));

  DiagnosticReport report;
  report.at = CaptureTime(seconds(1'700'000'000));
  report.hardware_id = "arm";
  report.parts = {{DiagnosticLevel::kWarn, "sextantd: pipeline", "late", {{"too_old", "3"}}}};
  publisher.publish_diagnostics(report);
  const Json diagnostics = take("diagnostics", "diagnostic_msgs/DiagnosticArray");
  EXPECT_EQ(diagnostics["status"][0]["level"], 1);
  EXPECT_EQ(diagnostics["status"][0]["name"], "sextantd: pipeline");
  EXPECT_EQ(diagnostics["status"][0]["values"][0]["value"], "3");
}

TEST_F(Interop, DiscoverySaysWhatTheManualSays) {
  const Publisher publisher(options());
  const std::vector<std::string> names = {
      "detections", "object_pose",         "pose_estimates", "tf",
      "markers",    "annotated/image_raw", "table_estimate", "diagnostics"};
  ASSERT_TRUE(eventually([&] {
    const auto found = peer_.discovered();
    return std::all_of(names.begin(), names.end(),
                       [&](const auto& name) { return found.count(topic(name)) > 0; });
  }));
  auto found = peer_.discovered();
  const auto expect = [&](const std::string& name, const std::string& type,
                          const char* hash) -> DiscoveredWriter& {
    DiscoveredWriter& w = found[topic(name)];
    EXPECT_EQ(w.type_name, MsgCodec::dds_type_name(type));
    EXPECT_EQ(w.user_data, std::string("typehash=") + hash + ";");
    EXPECT_TRUE(w.reliable) << name;
    EXPECT_EQ(w.transient_local, name == "pose_estimates");
    return w;
  };
  const DiscoveredWriter& detections =
      expect("detections", "vision_msgs/Detection3DArray", topic_type<Detection3DArrayMessage>().hash);
  EXPECT_NEAR(detections.deadline_ms, 400, 0.01);
  EXPECT_NEAR(detections.lease_ms, 400, 0.01);
  const DiscoveredWriter& native =
      expect("pose_estimates", "sextant_msgs/PoseEstimateArray", topic_type<PoseEstimateArrayMessage>().hash);
  EXPECT_NEAR(native.lifespan_ms, 60000, 0.01);
  EXPECT_EQ(native.deadline_ms, 0);
  EXPECT_EQ(
      expect("object_pose", "geometry_msgs/PoseStamped", topic_type<PoseStampedMessage>().hash).deadline_ms,
      0);
  expect("tf", "tf2_msgs/TFMessage", topic_type<TfMessage>().hash);
  expect("markers", "visualization_msgs/MarkerArray", topic_type<MarkerArrayMessage>().hash);
  expect("annotated/image_raw", "sensor_msgs/Image", topic_type<ImageMessage>().hash);
  expect("table_estimate", "sextant_msgs/TableEstimate", topic_type<TableEstimateMessage>().hash);
  expect("diagnostics", "diagnostic_msgs/DiagnosticArray", topic_type<DiagnosticArrayMessage>().hash);
}

TEST_F(Interop, ALateJoinerGetsTheLatchedEstimateAndABestEffortReaderIsServed) {
  Publisher publisher(options());
  publisher.publish(random_result(1, 1));
  const FrameResult last = random_result(2, 1);
  publisher.publish(last);
  FastDdsQos latched;
  latched.transient_local = true;
  subscribe("pose_estimates", "sextant_msgs/PoseEstimateArray", latched);
  expect_header(take("pose_estimates", "sextant_msgs/PoseEstimateArray")["header"], last);
  FastDdsQos sensor;
  sensor.reliable = false;
  sensor.depth = 5;
  subscribe("detections", "vision_msgs/Detection3DArray", sensor);
  ASSERT_TRUE(eventually([&] { return publisher.matched_readers() == 2; }));
  const FrameResult next = random_result(3, 0);
  publisher.publish(next);
  expect_header(take("detections", "vision_msgs/Detection3DArray")["header"], next);
}

TEST_F(Interop, ConsumersLearnThatWeAreGone) {
  auto publisher = std::make_unique<Publisher>(options());
  FastDdsQos strict;
  strict.lease_ms = 500;
  strict.deadline_ms = 500;
  subscribe("detections", "vision_msgs/Detection3DArray", strict);
  ASSERT_TRUE(eventually([&] { return publisher->matched_readers() == 1; }));
  ASSERT_TRUE(eventually([&] {
    publisher->publish(random_result(1, 0));
    return peer_.events(topic("detections")).alive == 1;
  }));
  // Frames stop: the deadline tells. (The process is still alive.)
  ASSERT_TRUE(eventually([&] { return peer_.events(topic("detections")).missed_deadlines > 0; }));
  EXPECT_EQ(peer_.events(topic("detections")).alive, 1);
  publisher.reset();
  EXPECT_TRUE(eventually([&] { return peer_.events(topic("detections")).alive == 0; }));
}

TEST_F(Interop, AStrangerWhoAsksTooMuchIsToldSo) {
  std::vector<std::string> warnings;
  Publisher publisher(options(), [&](const std::string& w) { warnings.push_back(w); });
  FastDdsQos strict;
  strict.lease_ms = 100;
  peer_.subscribe(topic("detections"), MsgCodec::dds_type_name("vision_msgs/Detection3DArray"), strict);
  EXPECT_TRUE(eventually([&] { return peer_.events(topic("detections")).incompatible > 0; }));
  EXPECT_TRUE(eventually([&] {
    publisher.publish(random_result(1, 0));
    return !warnings.empty();
  }));
  EXPECT_THAT(warnings, testing::Contains(testing::HasSubstr("shorter lease")));
}

TEST_F(Interop, AStrangersCommandIsServedAndAnswered) {
  Publisher publisher(options());
  CommandServer server(publisher.participant(), {domain_.name_space});
  peer_.advertise(topic("command"), MsgCodec::dds_type_name("sextant_msgs/Command"));
  subscribe("command_answer", "sextant_msgs/CommandAnswer");
  ASSERT_TRUE(eventually([&] { return peer_.matched_readers(topic("command")) > 0; }));
  const Json sent = {{"request_id", "fast-1"}, {"kind", 8},     {"object_name", "mug"},
                     {"model_file", ""},       {"value", -1.5}, {"region", {1, 2, 3, 4}}};
  const auto bytes = codec_.encode("sextant_msgs/Command", sent);
  std::vector<Command> got;
  // Sent again until it is there, as the manual says: our reader is best-effort, and it is done once.
  ASSERT_TRUE(eventually([&] {
    peer_.publish(topic("command"), bytes);
    for (Command& c : server.poll(milliseconds(10))) got.push_back(c);
    return !got.empty();
  }));
  EXPECT_TRUE(server.poll(milliseconds(50)).empty());
  EXPECT_EQ(got[0].request_id, "fast-1");
  EXPECT_EQ(got[0].kind, CommandKind::kLook);
  EXPECT_EQ(got[0].object_name, "mug");
  EXPECT_EQ(got[0].value, -1.5);
  EXPECT_EQ(got[0].region, (ImageRegion{1, 2, 3, 4}));
  CommandAnswer answer;
  answer.request_id = "fast-1";
  answer.kind = CommandKind::kLook;
  answer.message = "looked once: 1 pose";
  answer.objects = {{7, "mug", "mug.sxm", false, std::nullopt}};
  answer.look = random_result(4, 1);
  server.answer(answer);
  const Json json = take("command_answer", "sextant_msgs/CommandAnswer");
  EXPECT_EQ(json["request_id"], "fast-1");
  EXPECT_EQ(json["result"], 0);
  EXPECT_EQ(json["objects"][0]["object_id"], 7);
  EXPECT_EQ(json["objects"][0]["enabled"], false);
  EXPECT_TRUE(std::isnan(json["objects"][0]["threshold"].get<double>()));
  EXPECT_EQ(json["look"]["estimates"][0]["log_score"], answer.look->estimates[0].log_score);
}

TEST_F(Interop, AnImageOfAStrangerArrivesWhole) {
  peer_.advertise(topic("camera"), MsgCodec::dds_type_name("sensor_msgs/Image"));
  const QosPointer qos = make_qos({.reliable = false, .depth = 5});
  const RawReader reader(domain_.writing, *topic_type<ImageMessage>().descriptor, topic("camera"), qos.get());
  ASSERT_TRUE(
      eventually([&] { return reader.matched() == 1 && peer_.matched_readers(topic("camera")) == 1; }));
  std::vector<std::uint8_t> depth(640 * 480 * 2);
  std::iota(depth.begin(), depth.end(), std::uint8_t{0});
  const Json sent = {{"header", {{"stamp", {{"sec", 5}, {"nanosec", 6}}}, {"frame_id", "depth"}}},
                     {"height", 480},
                     {"width", 640},
                     {"encoding", "16UC1"},
                     {"step", 1280},
                     {"data", Json::binary(depth)}};
  const auto bytes = codec_.encode("sensor_msgs/Image", sent);
  void* sample = nullptr;
  dds_sample_info_t info{};
  ASSERT_TRUE(eventually([&] {
    peer_.publish(topic("camera"), bytes);
    return dds_take(reader.reader, &sample, &info, 1, 1) > 0 && info.valid_data;
  }));
  const auto& image = *static_cast<const ImageMessage*>(sample);
  EXPECT_EQ(image.header.stamp.nanosec, 6U);
  EXPECT_STREQ(image.encoding, "16UC1");
  EXPECT_EQ(image.step, 1280U);
  ASSERT_EQ(image.data._length, depth.size());
  EXPECT_TRUE(std::equal(depth.begin(), depth.end(), image.data._buffer));
  dds_return_loan(reader.reader, &sample, 1);
}

}  // namespace
}  // namespace sextant
