// SPDX-License-Identifier: Apache-2.0
// Over real DDS on loopback: a camera driver's topics become frames, faults included.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "dds_test_domain.h"
#include "hal/dds/dds_image_source.h"
#include "hal/dds/dds_rgbd_source.h"
#include "hal/dds/tf_listener.h"
#include "hal/table/table_locator.h"
#include "idl/dds/geometry_msgs.h"
#include "idl/dds/tf2_msgs.h"
#include "runtime/base/error.h"
#include "test_messages.h"

namespace sextant {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

/// Longer than discovery takes on a busy machine; reached only by a test that fails.
constexpr std::chrono::seconds kPatience{30};

class DdsCamera : public ::testing::Test {
 protected:
  DdsCamera() { writing_ = dds_create_participant(domain_.writing, nullptr, nullptr); }
  ~DdsCamera() override { dds_delete(writing_); }

  std::string topic(const std::string& name) const { return domain_.name_space + "/" + name; }

  /// Does it again and again until it is true.
  static bool until(const std::function<bool()>& done) {
    const auto end = Clock::now() + kPatience;
    while (!done()) {
      if (Clock::now() > end) return false;
      std::this_thread::yield();
    }
    return true;
  }

  DdsTestDomain domain_;
  dds_entity_t writing_ = 0;
};

TEST_F(DdsCamera, ImagesArrive) {
  TestWriter writer(writing_, &sensor_msgs_msg_dds__Image__desc, topic("image"));
  ASSERT_TRUE(writer.good());
  const auto source =
      open_dds_images(std::make_shared<DdsParticipant>(domain_.reading), {.topic = topic("image")});
  TestImage image("rgb8", 640, 480, 3, 0);
  image.fill({1, 2, 3});
  std::optional<RawImage> got;
  ASSERT_TRUE(until([&] {
    image.stamp(read_clocks().realtime);
    writer.write(&image.message());
    got = source->next(milliseconds(20));
    return got.has_value();
  }));
  EXPECT_EQ(got->width, 640);
  EXPECT_EQ(got->bytes[4], std::byte{2});
  EXPECT_EQ(source->state(), SourceState::kRunning);
  EXPECT_EQ(source->statistics().delivered, 1U);
}

TEST_F(DdsCamera, NonsenseIsCountedAndGoodImagesStillCome) {
  TestWriter writer(writing_, &sensor_msgs_msg_dds__Image__desc, topic("image"));
  const auto source =
      open_dds_images(std::make_shared<DdsParticipant>(domain_.reading), {.topic = topic("image")});
  ASSERT_TRUE(until([&] { return writer.matched() > 0; }));
  TestImage bad("bayer_rggb8", 64, 48, 1, 0);
  TestImage old("rgb8", 64, 48, 3, 0);
  old.stamp(read_clocks().realtime - std::chrono::hours(1));
  TestImage good("rgb8", 64, 48, 3, 0);
  ASSERT_TRUE(until([&] {
    writer.write(&bad.message());
    writer.write(&old.message());
    EXPECT_FALSE(source->next(milliseconds(20)));
    const SourceStatistics s = source->statistics();
    return s.drop(DropReason::kDamaged) > 0 && s.drop(DropReason::kBadTime) > 0;
  }));
  EXPECT_THAT(source->condition(), testing::HasSubstr("synchronise the clocks"));
  ASSERT_TRUE(until([&] {
    good.stamp(read_clocks().realtime);
    writer.write(&good.message());
    return source->next(milliseconds(20)).has_value();
  }));
  EXPECT_EQ(source->condition(), "");
}

TEST_F(DdsCamera, ForeignStampsCanBeReplaced) {
  TestWriter writer(writing_, &sensor_msgs_msg_dds__Image__desc, topic("image"));
  const auto source = open_dds_images(std::make_shared<DdsParticipant>(domain_.reading),
                                      {.topic = topic("image"), .stamp_on_arrival = true});
  TestImage old("rgb8", 64, 48, 3, 0);
  old.stamp(CaptureTime(std::chrono::seconds(77)));
  std::optional<RawImage> got;
  ASSERT_TRUE(until([&] {
    writer.write(&old.message());
    got = source->next(milliseconds(20));
    return got.has_value();
  }));
  EXPECT_LE(got->captured.realtime, read_clocks().realtime);
  EXPECT_GT(got->captured.realtime, read_clocks().realtime - std::chrono::minutes(5));
}

TEST_F(DdsCamera, SaysThatNobodyPublishesAndEndsAtOnce) {
  const auto source =
      open_dds_images(std::make_shared<DdsParticipant>(domain_.reading), {.topic = topic("none")});
  ASSERT_TRUE(until([&] {
    EXPECT_FALSE(source->next(milliseconds(50)));
    return source->state() == SourceState::kWaiting;
  }));
  EXPECT_EQ(source->condition(), "nobody publishes " + topic("none"));
  std::thread closer([&] { source->close(); });
  EXPECT_FALSE(source->next(std::chrono::hours(1)));
  closer.join();
  EXPECT_EQ(source->state(), SourceState::kEnded);
  EXPECT_THROW(open_dds_images(std::make_shared<DdsParticipant>(domain_.reading), {.topic = "/a b"}),
               UsageError);
}

TEST_F(DdsCamera, AStarvedReaderIsMadeAnewWithBackOff) {
  Clock::time_point now = Clock::now();
  SubscriptionOptions options;
  options.topic = topic("image");
  options.type = &sensor_msgs_msg_dds__Image__desc;
  options.now = [&] { return now; };
  Subscription subscription(std::make_shared<DdsParticipant>(domain_.reading), options);
  const auto poll = [&] { return subscription.wait_and_take(milliseconds(0), [](const void*) {}); };
  // Nobody was ever there: nothing to be starved of.
  now += std::chrono::minutes(5);
  poll();
  EXPECT_EQ(subscription.recreated(), 0U);
  TestWriter writer(writing_, &sensor_msgs_msg_dds__Image__desc, topic("image"));
  ASSERT_TRUE(until([&] { return subscription.matched_writers() > 0; }));
  poll();
  now += milliseconds(1900);
  poll();
  EXPECT_EQ(subscription.recreated(), 0U);
  now += milliseconds(200);
  poll();
  EXPECT_EQ(subscription.recreated(), 1U);
  now += milliseconds(2100);  // twice as patient now
  poll();
  EXPECT_EQ(subscription.recreated(), 1U);
  now += milliseconds(2000);
  poll();
  EXPECT_EQ(subscription.recreated(), 2U);
  // The fresh reader works, and a message makes the watchdog impatient again.
  TestImage image("rgb8", 64, 48, 3, 0);
  ASSERT_TRUE(until([&] {
    writer.write(&image.message());
    return subscription.wait_and_take(milliseconds(20), [](const void*) {}) > 0;
  }));
  while (poll() > 0) {
  }
  now += milliseconds(2100);
  poll();
  EXPECT_EQ(subscription.recreated(), 3U);
}

/// The four topics of an RGB-D driver.
struct Driver {
  TestWriter colour, depth, colour_info, depth_info;
  Driver(dds_entity_t participant, const std::string& name_space)
      : colour(participant, &sensor_msgs_msg_dds__Image__desc, name_space + "/color/image_raw"),
        depth(participant, &sensor_msgs_msg_dds__Image__desc, name_space + "/depth/image_raw"),
        colour_info(participant, &sensor_msgs_msg_dds__CameraInfo__desc, name_space + "/color/camera_info"),
        depth_info(participant, &sensor_msgs_msg_dds__CameraInfo__desc, name_space + "/depth/camera_info") {}

  void publish(TestInfo& of_colour, TestInfo& of_depth, unsigned side = 64) {
    const CaptureTime now = read_clocks().realtime;
    TestImage c("rgb8", side, side * 3 / 4, 3, 0);
    c.fill({9, 8, 7});
    c.stamp(now);
    TestImage d("16UC1", 64, 48, 2, 0);
    d.fill({0xE8, 0x03});  // 1000 mm
    d.stamp(now);
    colour_info.write(&of_colour.message());
    depth_info.write(&of_depth.message());
    colour.write(&c.message());
    depth.write(&d.message());
  }
};

DdsRgbdOptions rgbd_options(const DdsTestDomain& domain) {
  DdsRgbdOptions options;
  options.domain = domain.reading;
  options.colour_topic = domain.name_space + "/color/image_raw";
  options.depth_topic = domain.name_space + "/depth/image_raw";
  options.pairing.max_age = milliseconds(0);
  return options;
}

TEST_F(DdsCamera, AlignedTopicsBecomeFrames) {
  Driver driver(writing_, domain_.name_space);
  const auto source = open_dds_rgbd(rgbd_options(domain_));
  EXPECT_EQ(source->state(), SourceState::kWaiting);
  TestInfo info(64, 48, 60, "optical");
  TestInfo same(64, 48, 60, "optical");
  std::optional<RgbdFrame> frame;
  ASSERT_TRUE(until([&] {
    driver.publish(info, same);
    frame = source->next(milliseconds(50));
    return frame.has_value();
  })) << source->condition();
  EXPECT_EQ(frame->frame_id, "optical");
  EXPECT_EQ(frame->camera.fx, 60);
  EXPECT_EQ(frame->colour.at<cv::Vec3b>(10, 10), cv::Vec3b(9, 8, 7));
  EXPECT_FLOAT_EQ(frame->axial_depth_m.at<float>(10, 10), 1.0F);
}

TEST_F(DdsCamera, DepthIsRegisteredByTfAndFollowsAChangedCalibration) {
  Driver driver(writing_, domain_.name_space);
  TestWriter tf_static(writing_, &tf2_msgs_msg_dds__TFMessage__desc, "tf_static", true);
  const auto source = open_dds_rgbd(rgbd_options(domain_));
  TestInfo colour(128, 96, 120, "colour_optical");
  TestInfo depth(64, 48, 60, "depth_optical");
  ASSERT_TRUE(until([&] {
    driver.publish(colour, depth, 128);
    EXPECT_FALSE(source->next(milliseconds(20)));
    return source->condition().find("no transform connects") != std::string::npos;
  })) << source->condition();
  std::string parent = "colour_optical";
  std::string child = "depth_optical";
  geometry_msgs_msg_dds__TransformStamped_ transform{};
  transform.header.frame_id = parent.data();
  transform.child_frame_id = child.data();
  transform.transform.translation.x = -0.02;
  transform.transform.rotation.w = 1;
  tf2_msgs_msg_dds__TFMessage_ message{};
  message.transforms = {1, 1, &transform, false};
  tf_static.write(&message);
  std::optional<RgbdFrame> frame;
  ASSERT_TRUE(until([&] {
    driver.publish(colour, depth, 128);
    frame = source->next(milliseconds(50));
    return frame.has_value();
  })) << source->condition();
  EXPECT_EQ(frame->axial_depth_m.cols, 128);
  EXPECT_FLOAT_EQ(frame->axial_depth_m.at<float>(48, 64), 1.0F);
  // The driver restarts with another resolution.
  TestInfo smaller(64, 48, 61, "colour_optical");
  ASSERT_TRUE(until([&] {
    driver.publish(smaller, depth, 64);
    frame = source->next(milliseconds(50));
    return frame && frame->camera.fx == 61;
  })) << source->condition();
  EXPECT_GE(source->statistics().delivered, 2U);
}

TEST_F(DdsCamera, TheTableComesFromThePoseOfTheCamera) {
  TestWriter pose(writing_, &geometry_msgs_msg_dds__PoseStamped__desc, topic("camera_pose"));
  TableLocatorOptions options;
  options.origin = TableOrigin::kDds;
  options.domain = domain_.reading;
  options.pose_topic = topic("camera_pose");
  options.world_frame = "world";
  options.table_height_m = 0.75;
  options.height_deviation_m = 0.002;
  options.tilt_deviation_rad = 0.01;
  TableLocator locator(options);
  RgbdFrame frame;
  frame.frame_id = "optical";
  frame.captured_at = read_clocks().realtime;
  try {
    locator.locate(frame);
    FAIL() << "there is no pose yet";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("no transform connects"));
  }
  // Looking down by 0.6 rad from 1.35 m: camera z forward, x right, y down.
  const double pitch = 0.6;
  Eigen::Matrix3d r;
  r.col(0) = Eigen::Vector3d(0, -1, 0);
  r.col(2) = Eigen::Vector3d(std::cos(pitch), 0, -std::sin(pitch));
  r.col(1) = r.col(2).cross(r.col(0));
  const Eigen::Quaterniond q(r);
  std::string world = "world";
  geometry_msgs_msg_dds__PoseStamped_ message{};
  message.header.frame_id = world.data();
  message.pose.position.z = 1.35;
  message.pose.orientation = {q.x(), q.y(), q.z(), q.w()};
  ASSERT_TRUE(until([&] {
    const CaptureTime now = read_clocks().realtime;
    message.header.stamp.sec = static_cast<std::int32_t>(now.time_since_epoch().count() / 1'000'000'000);
    message.header.stamp.nanosec = static_cast<std::uint32_t>(now.time_since_epoch().count() % 1'000'000'000);
    pose.write(&message);
    frame.captured_at = now;
    try {
      locator.locate(frame);
      return true;
    } catch (const InputError&) {
      return false;
    }
  }));
  EXPECT_NEAR(frame.table->pitch_rad(), pitch, 1e-9);
  EXPECT_NEAR(frame.table->roll_rad(), 0, 1e-9);
  EXPECT_NEAR(frame.table->camera_height_m, 0.6, 1e-9);
  EXPECT_EQ(frame.table_uncertainty->tilt_rad, 0.01);
  EXPECT_GT(frame.table_uncertainty->surface_m, 0.002);
  // The pose is too old for a frame of two seconds later.
  frame.captured_at += std::chrono::seconds(2);
  EXPECT_THROW(locator.locate(frame), InputError);
}

TEST(TableBelow, RefusesACameraUnderTheTable) {
  RigidTransform t = RigidTransform::Identity();
  t.translation().z() = 0.7;
  EXPECT_FALSE(table_below(t, 0.75));
  EXPECT_TRUE(table_below(t, 0.2));
}

}  // namespace
}  // namespace sextant
