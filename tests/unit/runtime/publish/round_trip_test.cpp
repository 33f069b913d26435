// SPDX-License-Identifier: Apache-2.0
// What is published arrives with equal content, over the real Cyclone DDS and loopback UDP.
#include <gmock/gmock.h>

#include <functional>
#include <nlohmann/json.hpp>
#include <thread>
#include <vector>

#include "runtime/base/error.h"
#include "runtime/publish/echo_reader.h"
#include "runtime/publish/publisher.h"
#include "tests/unit/runtime/publish/dds_test_domain.h"
#include "tests/unit/runtime/publish/example_result.h"

namespace sextant {
namespace {

using Json = nlohmann::json;
using std::chrono::milliseconds;

constexpr auto kPatience = milliseconds(20000);

/// Listens to one topic and keeps what came.
struct Listener {
  std::vector<Json> messages;
  std::vector<std::string> texts, warnings;
  EchoReader reader;

  Listener(const DdsTestDomain& domain, const std::string& topic)
      : reader(
            {domain.reading, domain.name_space + "/" + topic, topic_kind_of(topic)},
            [this](const EchoMessage& message) {
              messages.push_back(Json::parse(message.json));
              texts.push_back(message.text);
            },
            [this](const std::string& warning) { warnings.push_back(warning); }) {}

  bool wait_for(const std::function<bool()>& condition) {
    const auto end = std::chrono::steady_clock::now() + kPatience;
    while (!condition()) {
      if (std::chrono::steady_clock::now() > end) return false;
      reader.poll(milliseconds(20));
    }
    return true;
  }
};

PublisherOptions options_of(const DdsTestDomain& domain) {
  PublisherOptions options;
  options.domain = domain.writing;
  options.name_space = domain.name_space;
  options.max_age_ms = 60000;
  return options;
}

/// Publisher and listener that see each other.
struct Pair {
  DdsTestDomain domain;
  Publisher publisher;
  Listener listener;

  explicit Pair(const std::string& topic, const std::string& config = "cyclonedds.xml")
      : domain(config), publisher(options_of(domain)), listener(domain, topic) {
    EXPECT_TRUE(listener.wait_for([&] { return listener.reader.matched_writers() > 0; }));
    EXPECT_TRUE(publisher.wait_for_reader(kPatience));
  }
};

void expect_transform(const Json& json, const RigidTransform& expected, double tolerance) {
  ASSERT_EQ(json.size(), 16U);
  for (unsigned i = 0; i < 16; ++i) {
    EXPECT_NEAR(json[i].get<double>(), expected.matrix()(i / 4, i % 4), tolerance) << i;
  }
}

void expect_header(const Json& header, const FrameResult& result) {
  const std::int64_t ns = header["stamp"]["sec"].get<std::int64_t>() * 1'000'000'000 +
                          header["stamp"]["nanosec"].get<std::int64_t>();
  EXPECT_EQ(ns, result.captured_at.time_since_epoch().count());
  EXPECT_EQ(header["frame_id"], result.frame_id);
}

TEST(RoundTrip, PoseEstimatesArriveEqual) {
  Pair pair("pose_estimates");
  for (unsigned seed = 0; seed < 5; ++seed) {
    const FrameResult sent = random_result(seed, static_cast<int>(seed));
    pair.listener.messages.clear();
    pair.publisher.publish(sent, 0.125);
    ASSERT_TRUE(pair.listener.wait_for([&] { return !pair.listener.messages.empty(); }));
    const Json& got = pair.listener.messages.front();
    expect_header(got["header"], sent);
    EXPECT_EQ(got["input_stamp"], got["header"]["stamp"]);
    EXPECT_EQ(got["frame_number"], sent.sequence);
    EXPECT_EQ(got["nodes"], sent.nodes);
    EXPECT_EQ(got["solve_time_s"], sent.seconds.total);
    EXPECT_NEAR(got["age_s"].get<double>(), 0.125, 1e-9);
    ASSERT_EQ(got["estimates"].size(), sent.estimates.size());
    for (std::size_t i = 0; i < sent.estimates.size(); ++i) {
      const Json& e = got["estimates"][i];
      const PoseEstimate& s = sent.estimates[i];
      EXPECT_EQ(e["object_id"], s.object_id);
      EXPECT_EQ(e["object_name"], s.object_name);
      EXPECT_EQ(e["score"], s.score);
      EXPECT_EQ(e["log_score"], s.log_score);
      EXPECT_EQ(e["upper_bound"], s.upper_bound);
      EXPECT_EQ(e["gap"], s.gap);
      EXPECT_EQ(e["runner_up_margin"], s.runner_up_margin);
      EXPECT_EQ(e["status"], to_string(s.status));
      expect_transform(e["camera_from_object"], s.camera_from_object, 1e-12);
      for (unsigned k = 0; k < 4; ++k) EXPECT_EQ(e["bbox"][k], s.bbox[k]);
      for (unsigned k = 0; k < 36; ++k) EXPECT_EQ(e["pose"]["covariance"][k], s.covariance(k / 6, k % 6));
    }
    ASSERT_EQ(got["objects"].size(), sent.objects.size());
    for (std::size_t i = 0; i < sent.objects.size(); ++i) {
      const Json& o = got["objects"][i];
      const ObjectOutcome& s = sent.objects[i];
      EXPECT_EQ(o["object_id"], s.object_id);
      EXPECT_EQ(o["object_name"], s.object_name);
      EXPECT_EQ(o["status"], to_string(s.status));
      EXPECT_EQ(o["upper_bound"], s.upper_bound);
      EXPECT_EQ(o["threshold"], s.threshold);
      EXPECT_EQ(o["coverage"], s.coverage);
    }
  }
  EXPECT_THAT(pair.listener.warnings, testing::IsEmpty());
  EXPECT_EQ(pair.publisher.statistics().published, 5U);
}

TEST(RoundTrip, DetectionsComeForEveryFrameAlsoEmptyOnes) {
  DdsTestDomain domain;
  PublisherOptions options = options_of(domain);
  options.object_shapes["object_0"] = {{0.1, 0.2, 0.3}, {0.4, 0.5, 0.6}, {}};
  Publisher publisher(options);
  Listener listener(domain, "detections");
  ASSERT_TRUE(listener.wait_for([&] { return listener.reader.matched_writers() > 0; }));
  ASSERT_TRUE(publisher.wait_for_reader(kPatience));
  for (const int poses : {0, 2}) {
    const FrameResult sent = random_result(7, poses);
    listener.messages.clear();
    publisher.publish(sent);
    ASSERT_TRUE(listener.wait_for([&] { return !listener.messages.empty(); }));
    const Json& got = listener.messages.front();
    expect_header(got["header"], sent);
    ASSERT_EQ(got["detections"].size(), sent.estimates.size());
    for (std::size_t i = 0; i < sent.estimates.size(); ++i) {
      const Json& d = got["detections"][i];
      EXPECT_EQ(d["id"], std::to_string(sent.estimates[i].object_id));
      ASSERT_EQ(d["results"].size(), 1U);
      EXPECT_EQ(d["results"][0]["hypothesis"]["class_id"], sent.estimates[i].object_name);
      EXPECT_EQ(d["results"][0]["hypothesis"]["score"], sent.estimates[i].score);
      expect_transform(d["results"][0]["camera_from_object"], sent.estimates[i].camera_from_object, 1e-12);
    }
    if (poses == 0) continue;
    const Eigen::Vector3d centre = sent.estimates[0].camera_from_object * Eigen::Vector3d(0.1, 0.2, 0.3);
    EXPECT_NEAR(got["detections"][0]["bbox"]["center"]["position"]["x"].get<double>(), centre.x(), 1e-12);
    EXPECT_NEAR(got["detections"][0]["bbox"]["center"]["position"]["z"].get<double>(), centre.z(), 1e-12);
    EXPECT_EQ(got["detections"][0]["bbox"]["size"]["y"], 0.5);
    EXPECT_EQ(got["detections"][1]["bbox"]["size"]["y"], 0.0);  // nobody told its box
  }
}

TEST(RoundTrip, ObjectPoseIsTheBestAndSilentWithoutOne) {
  Pair pair("object_pose");
  FrameResult sent = random_result(3, 3);
  for (PoseEstimate& e : sent.estimates) e.score = 0.5;
  sent.estimates[1].score = 0.9;
  pair.publisher.publish(random_result(3, 0));
  pair.publisher.publish(sent);
  ASSERT_TRUE(pair.listener.wait_for([&] { return !pair.listener.messages.empty(); }));
  ASSERT_EQ(pair.listener.messages.size(), 1U);  // writes arrive in order: the empty frame sent nothing
  expect_header(pair.listener.messages[0]["header"], sent);
  expect_transform(pair.listener.messages[0]["camera_from_object"], sent.estimates[1].camera_from_object,
                   1e-12);
}

TEST(RoundTrip, TransformsHaveAFrameForEveryPose) {
  DdsTestDomain domain;
  PublisherOptions options = options_of(domain);
  options.tf_prefix = "seen_";
  Publisher publisher(options);
  Listener listener(domain, "tf");
  ASSERT_TRUE(listener.wait_for([&] { return listener.reader.matched_writers() > 0; }));
  ASSERT_TRUE(publisher.wait_for_reader(kPatience));
  FrameResult sent = random_result(4, 3);
  sent.estimates[2].object_name = sent.estimates[0].object_name;
  publisher.publish(random_result(4, 0));  // no pose: no message
  publisher.publish(sent);
  ASSERT_TRUE(listener.wait_for([&] { return !listener.messages.empty(); }));
  const Json& transforms = listener.messages[0]["transforms"];
  ASSERT_EQ(transforms.size(), 3U);
  const std::vector<std::string> names = {"seen_object_0", "seen_object_1", "seen_object_0_2"};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(transforms[i]["child_frame_id"], names[i]);
    expect_header(transforms[i]["header"], sent);
    expect_transform(transforms[i]["camera_from_object"], sent.estimates[i].camera_from_object, 1e-12);
  }
}

TEST(RoundTrip, TheTableIsWhereThePosesStand) {
  Pair pair("table_estimate");
  FrameResult sent = random_result(6, 1);
  FrameResult without = sent;
  without.table.reset();
  pair.publisher.publish(without);  // silent
  pair.publisher.publish(sent);
  ASSERT_TRUE(pair.listener.wait_for([&] { return !pair.listener.messages.empty(); }));
  const Json& got = pair.listener.messages[0];
  expect_header(got["header"], sent);
  EXPECT_NEAR(got["pitch_rad"].get<double>(), 0.6, 1e-12);
  EXPECT_NEAR(got["roll_rad"].get<double>(), -0.1, 1e-12);
  EXPECT_EQ(got["camera_height_m"], 0.75);
  EXPECT_EQ(got["source"], 1);
  // The frame on the table: its z axis is the table's normal, its origin lies straight below the camera.
  const Json& q = got["pose"]["orientation"];
  const Json& p = got["pose"]["position"];
  const Eigen::Quaterniond rotation(q["w"], q["x"], q["y"], q["z"]);
  const Eigen::Vector3d up = sent.table->up_in_camera;
  EXPECT_LT((rotation * Eigen::Vector3d::UnitZ() - up).norm(), 1e-9);
  EXPECT_LT((Eigen::Vector3d(p["x"], p["y"], p["z"]) + 0.75 * up).norm(), 1e-9);
  EXPECT_GT((rotation * Eigen::Vector3d::UnitX()).z(), 0);  // x where the camera looks
}

TEST(RoundTrip, MarkersShowMeshesOrBoxesAxesAndNames) {
  DdsTestDomain domain;
  PublisherOptions options = options_of(domain);
  options.object_shapes["object_0"] = {{0, 0, 0}, {0.1, 0.2, 0.3}, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
  options.object_shapes["object_1"] = {{0, 0, 0}, {0.1, 0.2, 0.3}, {}};
  Publisher publisher(options);
  publisher.publish(random_result(1, 2));  // nobody listens: not even made
  Listener listener(domain, "markers");
  ASSERT_TRUE(listener.wait_for([&] { return listener.reader.matched_writers() > 0; }));
  ASSERT_TRUE(publisher.wait_for_reader(kPatience));
  FrameResult sent = random_result(8, 2);
  sent.estimates[0].score = 1;
  sent.estimates[1].score = 0;
  publisher.publish(sent);
  ASSERT_TRUE(listener.wait_for([&] { return !listener.messages.empty(); }));
  const Json& markers = listener.messages[0]["markers"];
  ASSERT_EQ(markers.size(), 7U);
  EXPECT_EQ(markers[0]["action"], 3);  // first everything of the frame before goes
  EXPECT_EQ(markers[1]["ns"], "shape");
  EXPECT_EQ(markers[1]["type"], 11);
  EXPECT_EQ(markers[1]["points"], 3);
  EXPECT_EQ(markers[1]["color"]["g"], 1);  // sure: green
  EXPECT_EQ(markers[1]["color"]["r"], 0);
  EXPECT_EQ(markers[2]["ns"], "axes");
  EXPECT_EQ(markers[2]["points"], 6);
  EXPECT_THAT(markers[3]["text"].get<std::string>(), testing::HasSubstr("object_0 1.00"));
  EXPECT_EQ(markers[4]["type"], 1);  // no mesh: its box
  EXPECT_EQ(markers[4]["scale"]["y"], 0.2);
  EXPECT_EQ(markers[4]["color"]["r"], 1);  // unsure: red
  EXPECT_EQ(markers[4]["color"]["g"], 0);
  for (std::size_t i = 0; i < markers.size(); ++i) {
    expect_header(markers[i]["header"], sent);
    EXPECT_EQ(markers[i]["lifetime"]["sec"], 60);  // max_age_ms of this test
  }
}

TEST(RoundTrip, TheAnnotatedImageIsOnlyWantedWhileSomeoneListens) {
  DdsTestDomain domain;
  Publisher publisher(options_of(domain));
  EXPECT_FALSE(publisher.annotated_wanted());
  const FrameResult sent = random_result(2, 1);
  {
    Listener listener(domain, "annotated/image_raw");
    ASSERT_TRUE(listener.wait_for([&] { return listener.reader.matched_writers() > 0; }));
    ASSERT_TRUE(listener.wait_for([&] { return publisher.annotated_wanted(); }));
    publisher.publish_annotated(sent, cv::Mat(48, 64, CV_8UC3, cv::Scalar(1, 2, 3)));
    ASSERT_TRUE(listener.wait_for([&] { return !listener.messages.empty(); }));
    const Json& got = listener.messages[0];
    expect_header(got["header"], sent);
    EXPECT_EQ(got["width"], 64);
    EXPECT_EQ(got["height"], 48);
    EXPECT_EQ(got["step"], 192);
    EXPECT_EQ(got["encoding"], "rgb8");
  }
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (publisher.annotated_wanted() && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(milliseconds(10));
  EXPECT_FALSE(publisher.annotated_wanted());
}

TEST(RoundTrip, DiagnosticsArriveEqual) {
  Pair pair("diagnostics");
  DiagnosticReport sent;
  sent.at = CaptureTime(std::chrono::nanoseconds(1'700'000'000'000'000'042));
  sent.hardware_id = "arm";
  sent.parts = {{DiagnosticLevel::kWarn,
                 "sextantd: pipeline",
                 "3 frames dropped",
                 {{"dropped", "3"}, {"rate_hz", "30"}}},
                {DiagnosticLevel::kOk, "sextantd: DDS", "", {}}};
  pair.publisher.publish_diagnostics(sent);
  ASSERT_TRUE(pair.listener.wait_for([&] { return !pair.listener.messages.empty(); }));
  const Json& got = pair.listener.messages[0];
  EXPECT_EQ(got["header"]["stamp"]["nanosec"], 42);
  ASSERT_EQ(got["status"].size(), 2U);
  EXPECT_EQ(got["status"][0]["level"], 1);
  EXPECT_EQ(got["status"][0]["name"], "sextantd: pipeline");
  EXPECT_EQ(got["status"][0]["hardware_id"], "arm");
  EXPECT_EQ(got["status"][0]["values"]["dropped"], "3");
  EXPECT_EQ(got["status"][1]["values"].size(), 0U);
}

TEST(RoundTrip, TopicsThatAreOffDoNotExistAndAbsoluteOnesHaveNoNamespace) {
  DdsTestDomain domain;
  PublisherOptions options = options_of(domain);
  for (std::string* topic :
       {&options.detections_topic, &options.object_pose_topic, &options.pose_estimates_topic,
        &options.markers_topic, &options.annotated_topic, &options.table_topic, &options.diagnostics_topic})
    topic->clear();
  options.tf_topic = "/" + domain.name_space + "_elsewhere/tf";
  Publisher publisher(options);
  Listener namespaced(domain, "tf");
  EchoReader absolute({domain.reading, domain.name_space + "_elsewhere/tf", TopicKind::kTf},
                      [](const EchoMessage&) {});
  // Each side hears of the other in its own time.
  ASSERT_TRUE(namespaced.wait_for(
      [&] { return absolute.matched_writers() == 1 && publisher.matched_readers() == 1; }));
  EXPECT_EQ(namespaced.reader.matched_writers(), 0);
  publisher.publish(random_result(1, 1));
  publisher.publish_annotated(random_result(1, 1), cv::Mat(2, 2, CV_8UC3, cv::Scalar()));
  publisher.publish_diagnostics({});
  EXPECT_EQ(publisher.matched_readers(), 1);
}

TEST(RoundTrip, InfiniteBoundsArriveAsNull) {
  Pair pair("pose_estimates");
  FrameResult sent = random_result(1, 1);
  sent.objects[0].upper_bound = std::numeric_limits<double>::infinity();
  pair.publisher.publish(sent);
  ASSERT_TRUE(pair.listener.wait_for([&] { return !pair.listener.messages.empty(); }));
  EXPECT_TRUE(pair.listener.messages[0]["objects"][0]["upper_bound"].is_null());
}

TEST(RoundTrip, TheSettingsForALanLoadToo) {
  // No message is awaited: whether a machine has a network with multicast is not ours to say.
  DdsTestDomain domain("cyclonedds-lan.xml");
  Publisher publisher(options_of(domain));
  publisher.publish(random_result(1, 1));
  EXPECT_EQ(publisher.statistics().published, 1U);
}

TEST(RoundTrip, AReaderIsToldWhenThePublisherGoes) {
  DdsTestDomain domain;
  auto publisher = std::make_unique<Publisher>(options_of(domain));
  Listener listener(domain, "detections");
  ASSERT_TRUE(listener.wait_for([&] { return listener.reader.matched_writers() > 0; }));
  publisher.reset();
  EXPECT_TRUE(listener.wait_for([&] { return !listener.warnings.empty(); }));
  EXPECT_THAT(listener.warnings, testing::ElementsAre(testing::HasSubstr("a publisher has gone")));
}

TEST(RoundTrip, WhoLeavesIsGoneAtOnceAndWritesNoMore) {
  const DdsTestDomain domain;
  PublisherOptions options;
  options.domain = domain.writing;
  options.name_space = domain.name_space;
  Publisher publisher(options);
  EchoReader reader({domain.reading, domain.name_space + "/pose_estimates", TopicKind::kPoseEstimates},
                    [](const EchoMessage&) {});
  ASSERT_TRUE(publisher.wait_for_reader(std::chrono::seconds(20)));
  const auto until = [&](int writers) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    while (reader.matched_writers() != writers && std::chrono::steady_clock::now() < end)
      reader.poll(std::chrono::milliseconds(10));
    return reader.matched_writers() == writers;
  };
  EXPECT_TRUE(until(1));
  publisher.leave();
  EXPECT_TRUE(until(0));
  EXPECT_THROW(publisher.publish(random_result(1, 1)), DeviceError);
}

TEST(RoundTrip, WhatHasGrownTooOldIsCountedAndNotWritten) {
  const DdsTestDomain domain;
  PublisherOptions options;
  options.domain = domain.writing;
  options.name_space = domain.name_space;
  options.max_age_ms = 60'000;
  std::vector<std::string> warnings;
  Publisher publisher(options, [&](const std::string& w) { warnings.push_back(w); });
  std::vector<std::int64_t> frames;
  EchoReader reader({domain.reading, domain.name_space + "/pose_estimates", TopicKind::kPoseEstimates},
                    [&](const EchoMessage& m) {
                      frames.push_back(nlohmann::json::parse(m.json)["frame_number"].get<std::int64_t>());
                    });
  ASSERT_TRUE(publisher.wait_for_reader(std::chrono::seconds(20)));
  FrameResult result = random_result(1, 1);
  result.sequence = 7;
  publisher.publish(result, 61);
  // Estimates, best pose, transforms, detections; a table where the result has one.
  EXPECT_GE(publisher.statistics().too_old, 4U);
  EXPECT_THAT(warnings, testing::Contains(testing::HasSubstr("older than 60000 ms")));
  const auto before = publisher.statistics().too_old;
  result.sequence = 8;
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (frames.empty() && std::chrono::steady_clock::now() < end) {
    publisher.publish(result, 0.5);
    reader.poll(std::chrono::milliseconds(20));
  }
  EXPECT_THAT(frames, testing::Contains(8));
  EXPECT_THAT(frames, testing::Not(testing::Contains(7)));
  EXPECT_EQ(publisher.statistics().too_old, before);
}

}  // namespace
}  // namespace sextant
