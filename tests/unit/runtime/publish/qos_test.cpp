// SPDX-License-Identifier: Apache-2.0
// Our writers as other participants discover them: QoS, type hashes, latching, and readers that ask too much.
#include <gmock/gmock.h>

#include <vector>

#include "runtime/publish/message_types.h"
#include "runtime/publish/publisher.h"
#include "tests/unit/runtime/publish/dds_test_domain.h"
#include "tests/unit/runtime/publish/example_result.h"
#include "tests/unit/runtime/publish/raw_reader.h"

namespace sextant {
namespace {

PublisherOptions options_of(const DdsTestDomain& domain) {
  PublisherOptions options;
  options.domain = domain.writing;
  options.name_space = domain.name_space;
  options.lease_ms = 400;
  options.max_age_ms = 700;
  return options;
}

/// What a reader learned of the one writer it matched.
struct DiscoveredQos {
  dds_reliability_kind_t reliability{};
  dds_durability_kind_t durability{};
  dds_duration_t deadline = DDS_INFINITY, lease = DDS_INFINITY, lifespan = DDS_INFINITY;
  std::string user_data, type_name;
};

DiscoveredQos discover(const DdsTestDomain& domain, const dds_topic_descriptor_t& type,
                       const std::string& topic) {
  DiscoveredQos found;
  const QosPointer qos = make_qos({.reliable = false});
  const RawReader raw(domain.reading, type, "rt/" + domain.name_space + "/" + topic, qos.get());
  EXPECT_TRUE(eventually([&] { return raw.matched() == 1; }));
  dds_instance_handle_t writer = 0;
  EXPECT_EQ(dds_get_matched_publications(raw.reader, &writer, 1), 1);
  dds_builtintopic_endpoint_t* endpoint = dds_get_matched_publication_data(raw.reader, writer);
  EXPECT_NE(endpoint, nullptr);
  if (endpoint == nullptr) return found;
  dds_duration_t blocking = 0;
  dds_liveliness_kind_t liveliness{};
  void* user_data = nullptr;
  std::size_t size = 0;
  EXPECT_TRUE(dds_qget_reliability(endpoint->qos, &found.reliability, &blocking));
  EXPECT_TRUE(dds_qget_durability(endpoint->qos, &found.durability));
  dds_qget_deadline(endpoint->qos, &found.deadline);
  dds_qget_liveliness(endpoint->qos, &liveliness, &found.lease);
  dds_qget_lifespan(endpoint->qos, &found.lifespan);
  EXPECT_TRUE(dds_qget_userdata(endpoint->qos, &user_data, &size));
  found.user_data.assign(static_cast<const char*>(user_data), size);
  found.type_name = endpoint->type_name;
  dds_free(user_data);
  dds_builtintopic_free_endpoint(endpoint);
  return found;
}

TEST(Qos, OfEachTopicIsAsDocumented) {
  const DdsTestDomain domain;
  const Publisher publisher(options_of(domain));

  const DiscoveredQos detections =
      discover(domain, vision_msgs_msg_dds__Detection3DArray__desc, "detections");
  EXPECT_EQ(detections.type_name, "vision_msgs::msg::dds_::Detection3DArray_");
  EXPECT_EQ(detections.reliability, DDS_RELIABILITY_RELIABLE);
  EXPECT_EQ(detections.durability, DDS_DURABILITY_VOLATILE);
  EXPECT_EQ(detections.deadline, DDS_MSECS(400));
  EXPECT_EQ(detections.lease, DDS_MSECS(400));
  EXPECT_EQ(detections.lifespan, DDS_INFINITY);
  EXPECT_EQ(detections.user_data, std::string("typehash=") + kTypeHashDetection3DArray + ";");

  const DiscoveredQos pose = discover(domain, geometry_msgs_msg_dds__PoseStamped__desc, "object_pose");
  EXPECT_EQ(pose.type_name, "geometry_msgs::msg::dds_::PoseStamped_");
  EXPECT_EQ(pose.reliability, DDS_RELIABILITY_RELIABLE);
  EXPECT_EQ(pose.durability, DDS_DURABILITY_VOLATILE);
  EXPECT_EQ(pose.deadline, DDS_INFINITY);
  EXPECT_EQ(pose.lease, DDS_MSECS(400));
  EXPECT_EQ(pose.user_data, std::string("typehash=") + kTypeHashPoseStamped + ";");

  const DiscoveredQos native =
      discover(domain, sextant_msgs_msg_dds__PoseEstimateArray__desc, "pose_estimates");
  EXPECT_EQ(native.type_name, "sextant_msgs::msg::dds_::PoseEstimateArray_");
  EXPECT_EQ(native.reliability, DDS_RELIABILITY_RELIABLE);
  EXPECT_EQ(native.durability, DDS_DURABILITY_TRANSIENT_LOCAL);
  EXPECT_EQ(native.deadline, DDS_INFINITY);
  EXPECT_EQ(native.lifespan, DDS_MSECS(700));
  EXPECT_EQ(native.user_data, std::string("typehash=") + kTypeHashPoseEstimateArray + ";");
}

TEST(Qos, ALateJoinerGetsTheLastEstimateButNeverAnOldOne) {
  const DdsTestDomain domain;
  PublisherOptions options = options_of(domain);
  const std::string topic = "rt/" + domain.name_space + "/pose_estimates";
  const QosPointer latched = make_qos({.transient_local = true, .depth = 10});

  options.max_age_ms = 600000;
  Publisher keeps(options);
  keeps.publish(random_result(1, 1));
  keeps.publish(random_result(2, 1));
  const RawReader late(domain.reading, sextant_msgs_msg_dds__PoseEstimateArray__desc, topic, latched.get());
  int received = 0;
  EXPECT_TRUE(eventually([&] { return (received += late.take()) > 0; }));
  EXPECT_EQ(received, 1);  // keep-last 1: only the second

  options.name_space += "_short";
  options.max_age_ms = 50;
  Publisher forgets(options);
  forgets.publish(random_result(3, 1));
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  const RawReader later(domain.reading, sextant_msgs_msg_dds__PoseEstimateArray__desc,
                        "rt/" + options.name_space + "/pose_estimates", latched.get());
  ASSERT_TRUE(eventually([&] { return later.matched() == 1; }));
  options.max_age_ms = 600000;
  // A message of the same topic that must come, so that the old one had its chance.
  Publisher marker(options);
  ASSERT_TRUE(eventually([&] { return later.matched() == 2; }));
  ASSERT_TRUE(marker.wait_for_reader(std::chrono::seconds(20)));
  marker.publish(random_result(4, 1));
  received = 0;
  EXPECT_TRUE(eventually([&] { return (received += later.take()) > 0; }));
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_EQ(received + later.take(), 1);
}

TEST(Qos, AReaderThatAsksTooMuchIsReportedInWords) {
  const DdsTestDomain domain;
  std::vector<std::string> warnings;
  Publisher publisher(options_of(domain), [&](const std::string& w) { warnings.push_back(w); });
  const QosPointer strict = make_qos({.lease_ms = 100});
  const RawReader raw(domain.reading, vision_msgs_msg_dds__Detection3DArray__desc,
                      "rt/" + domain.name_space + "/detections", strict.get());
  EXPECT_TRUE(eventually([&] {
    publisher.publish(random_result(1, 1));
    return !warnings.empty();
  }));
  EXPECT_THAT(warnings, testing::Contains(testing::HasSubstr("shorter lease")));
  EXPECT_EQ(raw.matched(), 0);
}

TEST(Qos, ReliableReadersGetEverythingBeforeTheWaitEnds) {
  const DdsTestDomain domain;
  PublisherOptions options = options_of(domain);
  options.object_pose_topic.clear();
  options.pose_estimates_topic.clear();
  Publisher publisher(options);
  const QosPointer reliable = make_qos({.depth = 10});
  const RawReader raw(domain.reading, vision_msgs_msg_dds__Detection3DArray__desc,
                      "rt/" + domain.name_space + "/detections", reliable.get());
  ASSERT_TRUE(publisher.wait_for_reader(std::chrono::seconds(20)));
  ASSERT_TRUE(eventually([&] { return raw.matched() == 1 && publisher.matched_readers() > 0; }));
  EXPECT_EQ(publisher.matched_readers(), 1);  // the topics that are off have no writer
  for (unsigned i = 0; i < 5; ++i) publisher.publish(random_result(i, 20));
  EXPECT_TRUE(publisher.wait_for_acknowledgements(std::chrono::seconds(20)));
  int received = 0;
  EXPECT_TRUE(eventually([&] { return (received += raw.take()) >= 5; }));
  EXPECT_EQ(received, 5);
}

}  // namespace
}  // namespace sextant
