// SPDX-License-Identifier: Apache-2.0
// Messages of a stranger: refused with a reason, printed without harm, and no obstacle to the good ones.
#include <gmock/gmock.h>

#include <functional>
#include <limits>
#include <nlohmann/json.hpp>

#include "runtime/base/error.h"
#include "runtime/publish/echo_reader.h"
#include "runtime/publish/message_builder.h"
#include "runtime/publish/message_check.h"
#include "runtime/publish/message_text.h"
#include "tests/unit/runtime/publish/dds_test_domain.h"
#include "tests/unit/runtime/publish/example_result.h"
#include "tests/unit/runtime/publish/raw_reader.h"

namespace sextant {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A valid message that may be damaged; the builder keeps its memory.
struct Damageable {
  FrameResult result = random_result(2, 2);
  PoseEstimatesBuilder builder{result, 0.25};
  PoseEstimateArrayMessage message = builder.message();
};

TEST(HostileMessage, IsRefusedForEachReason) {
  using Message = PoseEstimateArrayMessage;
  const std::string huge(5000, 'x');
  const std::vector<std::function<void(Message&)>> damages = {
      [](Message& m) { m.header.stamp.sec = -1; },
      [](Message& m) { m.header.stamp.nanosec = 1'000'000'000; },
      [](Message& m) { m.input_stamp.nanosec = 4'000'000'000U; },
      [&](Message& m) { m.header.frame_id = const_cast<char*>(huge.c_str()); },
      [&](Message& m) { m.message = const_cast<char*>(huge.c_str()); },
      [](Message& m) { m.solve_time_s = -1; },
      [](Message& m) { m.solve_time_s = kInfinity; },
      [](Message& m) { m.estimates._buffer[1].pose.pose.position.x = kNan; },
      [](Message& m) { m.estimates._buffer[1].pose.pose.position.y = 1e300; },
      [](Message& m) {
        m.estimates._buffer[0].pose.pose.orientation = {0, 0, 0, 0};
      },
      [](Message& m) { m.estimates._buffer[0].pose.pose.orientation.w = kNan; },
      [](Message& m) { m.estimates._buffer[0].pose.pose.orientation.w = 7; },
      [](Message& m) { m.estimates._buffer[0].pose.covariance[5] = kInfinity; },
      [](Message& m) { m.estimates._buffer[0].pose.covariance[7] = -1; },
      [](Message& m) { m.estimates._buffer[0].score = 1.1; },
      [](Message& m) { m.estimates._buffer[0].score = kNan; },
      [](Message& m) { m.estimates._buffer[0].log_score = kNan; },
      [](Message& m) { m.estimates._buffer[0].gap = -0.1; },
      [](Message& m) { m.estimates._buffer[0].runner_up_margin = kNan; },
      [](Message& m) { m.age_s = kInfinity; },
      [](Message& m) { m.estimates._buffer[0].status = 3; },
      [](Message& m) { m.estimates._buffer[0].bbox[0] = kNan; },
      [](Message& m) { m.estimates._buffer[0].bbox[3] = -2; },
      [](Message& m) { m.objects._buffer[0].status = 255; },
      [](Message& m) { m.objects._buffer[0].coverage = kNan; },
      [](Message& m) { m.objects._buffer[0].threshold = kNan; },
      [](Message& m) { m.objects._length = 4'000'000'000U; },
  };
  for (std::size_t i = 0; i < damages.size(); ++i) {
    Damageable d;
    EXPECT_NO_THROW(check_message(d.message, "rt/t"));
    damages[i](d.message);
    EXPECT_THROW(check_message(d.message, "rt/t"), InputError) << "damage " << i;
  }
}

TEST(HostileMessage, OfTheRosTypesIsRefusedToo) {
  const FrameResult result = random_result(2, 2);
  const auto refused = [&](const std::function<void(Detection3DArrayMessage&)>& damage) {
    const DetectionsBuilder builder(result, {});
    Detection3DArrayMessage message = builder.message();
    EXPECT_NO_THROW(check_message(message, "rt/t"));
    damage(message);
    EXPECT_THROW(check_message(message, "rt/t"), InputError);
  };
  refused([](auto& m) { m.detections._length = 4'000'000'000U; });
  refused([](auto& m) { m.detections._buffer[0].results._length = 4'000'000'000U; });
  refused([](auto& m) { m.detections._buffer[1].bbox.size.x = -1; });
  refused([](auto& m) { m.detections._buffer[1].bbox.center.orientation.x = kNan; });
  refused([](auto& m) { m.detections._buffer[1].results._buffer[0].hypothesis.score = kInfinity; });
  refused([](auto& m) { m.detections._buffer[1].results._buffer[0].pose.pose.position.z = -kInfinity; });
  PoseStampedMessage pose = *build_object_pose(result);
  EXPECT_NO_THROW(check_message(pose, "rt/t"));
  pose.pose.orientation.z = 2;
  EXPECT_THROW(check_message(pose, "rt/t"), InputError);
}

TEST(HostileMessage, OfTheOtherTopicsIsRefusedToo) {
  char empty[] = "";
  std::vector<std::uint8_t> pixels(12);
  ImageMessage image{};
  image.header.frame_id = image.encoding = empty;
  image.width = 2;
  image.height = 2;
  image.step = 6;
  image.data = {12, 12, pixels.data(), false};
  EXPECT_NO_THROW(check_message(image, "rt/t"));
  image.height = 3;
  EXPECT_THROW(check_message(image, "rt/t"), InputError);
  image.height = 0x80000000U;  // step * height would wrap to 0 in 32 bits
  image.step = 2;
  image.data._length = 0;
  EXPECT_THROW(check_message(image, "rt/t"), InputError);

  const FrameResult result = random_result(2, 2);
  TfBuilder transforms(result, "");
  TfMessage tf = transforms.message();
  EXPECT_NO_THROW(check_message(tf, "rt/t"));
  tf.transforms._buffer[1].transform.translation.x = kNan;
  EXPECT_THROW(check_message(tf, "rt/t"), InputError);

  const auto table_refused = [&](const std::function<void(TableEstimateMessage&)>& damage) {
    TableEstimateMessage table = *build_table_estimate(result);
    EXPECT_NO_THROW(check_message(table, "rt/t"));
    damage(table);
    EXPECT_THROW(check_message(table, "rt/t"), InputError);
  };
  table_refused([](auto& t) { t.up_in_camera.x += 1; });
  table_refused([](auto& t) { t.camera_height_m = kInfinity; });
  table_refused([](auto& t) { t.pitch_rad = kNan; });

  CommandMessage command{};
  command.object_name = command.model_file = empty;
  for (const std::string& id : {std::string("a"), std::string(64, 'b')}) {
    command.request_id = const_cast<char*>(id.c_str());
    EXPECT_NO_THROW(check_message(command, "rt/t"));
  }
  for (const std::string& id :
       {std::string(), std::string(65, 'b'), std::string("a\nb"), std::string("\xc3\xa9")}) {
    command.request_id = const_cast<char*>(id.c_str());
    EXPECT_THROW(check_message(command, "rt/t"), InputError);
  }
}

TEST(HostileMessage, CannotSpeakToTheTerminal) {
  FrameResult result = random_result(2, 1);
  result.frame_id = "\x1b[2Jcamera\r\n";
  result.estimates[0].object_name = "\xff\xfe\x80 mug\"\\";
  const PoseEstimatesBuilder builder(result, 0.25);
  for (const std::string& out : {to_text(builder.message()), to_json(builder.message())}) {
    for (const char c : out) EXPECT_TRUE(c == '\n' || (c >= ' ' && c <= '~')) << static_cast<int>(c);
  }
  const auto json = nlohmann::json::parse(to_json(builder.message()));
  EXPECT_EQ(json["header"]["frame_id"], "?[2Jcamera??");
  EXPECT_EQ(json["estimates"][0]["object_name"], "??? mug\"\\");
}

TEST(HostileMessage, DoesNotStopTheGoodOnes) {
  const DdsTestDomain domain;
  const std::string topic = domain.name_space + "/pose_estimates";
  const DdsEntity participant = create_participant(domain.writing);
  const dds_entity_t t = dds_create_topic(participant.get(), &sextant_msgs_msg_dds__PoseEstimateArray__desc,
                                          ("rt/" + topic).c_str(), nullptr, nullptr);
  const QosPointer qos = make_qos({});
  const dds_entity_t writer =
      check_dds(dds_create_writer(participant.get(), t, qos.get(), nullptr), "writer");

  std::vector<std::string> received, warnings;
  EchoReader reader(
      {domain.reading, topic, TopicKind::kPoseEstimates},
      [&](const EchoMessage& m) { received.push_back(m.json); },
      [&](const std::string& w) { warnings.push_back(w); });
  ASSERT_TRUE(eventually([&] {
    dds_publication_matched_status_t status{};
    dds_get_publication_matched_status(writer, &status);
    return status.current_count > 0 && reader.matched_writers() > 0;
  }));
  Damageable d;
  d.message.estimates._buffer[0].pose.pose.position.x = kNan;
  check_dds(dds_write(writer, &d.message), "write");
  d.message.estimates._buffer[0].pose.pose.position.x = 1;
  check_dds(dds_write(writer, &d.message), "write");
  EXPECT_TRUE(eventually([&] { return reader.poll(std::chrono::milliseconds(0)) > 0; }));
  EXPECT_EQ(received.size(), 1U);
  EXPECT_EQ(reader.refused(), 1U);
  EXPECT_THAT(warnings, testing::ElementsAre(testing::HasSubstr("position is not finite")));
}

}  // namespace
}  // namespace sextant
