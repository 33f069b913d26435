// SPDX-License-Identifier: Apache-2.0
// What is published arrives with equal content, over the real Cyclone DDS and loopback UDP.
#include <gmock/gmock.h>

#include <functional>
#include <nlohmann/json.hpp>
#include <thread>
#include <vector>

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
    pair.publisher.publish(sent);
    ASSERT_TRUE(pair.listener.wait_for([&] { return !pair.listener.messages.empty(); }));
    const Json& got = pair.listener.messages.front();
    expect_header(got["header"], sent);
    EXPECT_EQ(got["input_stamp"], got["header"]["stamp"]);
    EXPECT_EQ(got["frame_number"], sent.sequence);
    EXPECT_EQ(got["nodes"], sent.nodes);
    EXPECT_EQ(got["solve_time_s"], sent.seconds.total);
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
  options.object_boxes["object_0"] = {{0.1, 0.2, 0.3}, {0.4, 0.5, 0.6}};
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

}  // namespace
}  // namespace sextant
