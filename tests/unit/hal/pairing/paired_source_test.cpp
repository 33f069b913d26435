// SPDX-License-Identifier: Apache-2.0
#include "hal/pairing/paired_source.h"

#include <gtest/gtest.h>

#include "runtime/base/error.h"
#include "scripted_stream.h"

namespace sextant {
namespace {

using std::chrono::milliseconds;

constexpr int kWidth = 64;
constexpr int kHeight = 48;
/// Longer than any test machine stalls; reached only by a test that fails.
constexpr milliseconds kPatience{20000};

class PairedSourceTest : public ::testing::Test {
 protected:
  PairedSourceTest() {
    CameraModel& c = options.calibration.colour;
    c = {.width = kWidth, .height = kHeight, .fx = 60, .fy = 60, .cx = 31.5, .cy = 23.5};
    options.calibration.depth_is_registered = true;
    options.frame_id = "camera";
    options.now = [this] { return now; };
  }

  void open() {
    source = pair_streams(std::make_unique<ScriptedStream>(colour, "colour"),
                          std::make_unique<ScriptedStream>(depth, "depth"), options);
  }
  MonotonicTime at(int ms) const { return start + milliseconds(ms); }
  void push_colour(int ms, unsigned value, std::int64_t sequence) {
    colour->push(image_of(PixelFormat::kRgb24, kWidth, kHeight, value, at(ms), sequence));
  }
  void push_depth(int ms, unsigned value, std::int64_t sequence) {
    depth->push(image_of(PixelFormat::kZ16, kWidth, kHeight, value, at(ms), sequence));
  }

  MonotonicTime start{std::chrono::hours(5)};
  MonotonicTime now = start;
  std::shared_ptr<StreamScript> colour = std::make_shared<StreamScript>();
  std::shared_ptr<StreamScript> depth = std::make_shared<StreamScript>();
  PairedSourceOptions options;
  std::unique_ptr<FrameSource> source;
};

TEST_F(PairedSourceTest, MakesFramesOfPairs) {
  open();
  push_depth(2, 812, 90);
  push_colour(2, 77, 40);
  const auto frame = source->next(kPatience);
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->colour.at<cv::Vec3b>(20, 20), cv::Vec3b(77, 77, 77));
  EXPECT_NEAR(frame->axial_depth_m.at<float>(20, 20), 0.812, 1e-6);
  EXPECT_EQ(frame->sequence, 40);
  EXPECT_EQ(frame->captured_monotonic, at(2));
  EXPECT_NE(frame->captured_at, CaptureTime{});
  EXPECT_EQ(frame->frame_id, "camera");
  EXPECT_EQ(source->statistics().delivered, 1U);
  EXPECT_EQ(source->state(), SourceState::kRunning);
}

TEST_F(PairedSourceTest, HandsOutTheNewestAndCountsTheRest) {
  for (int i = 0; i < 4; ++i) {
    push_colour(33 * i, 10U + static_cast<unsigned>(i), i);
    push_depth(33 * i, 1000, i);
  }
  colour->end();
  depth->end();
  options.max_age = milliseconds(0);
  open();
  std::int64_t last = -1;
  while (source->state() != SourceState::kEnded) {
    const auto frame = source->next(kPatience);
    if (!frame) continue;
    EXPECT_GT(frame->sequence, last);
    last = frame->sequence;
  }
  EXPECT_EQ(last, 3);
  const SourceStatistics s = source->statistics();
  EXPECT_EQ(s.delivered + s.drop(DropReason::kSuperseded), 4U);
}

TEST_F(PairedSourceTest, NeverHandsOutAStaleFrame) {
  open();
  now = at(500);
  push_colour(0, 1, 0);
  push_depth(0, 1000, 0);
  push_colour(450, 2, 1);
  push_depth(450, 1000, 1);
  const auto frame = source->next(kPatience);
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->sequence, 1);
  const SourceStatistics s = source->statistics();
  EXPECT_EQ(s.drop(DropReason::kStale) + s.drop(DropReason::kSuperseded), 1U);
}

TEST_F(PairedSourceTest, AnotherSizeIsRefusedAndSaid) {
  open();
  colour->push(image_of(PixelFormat::kRgb24, kWidth / 2, kHeight, 1, at(0), 0));
  push_colour(33, 2, 1);
  push_depth(33, 1000, 1);
  ASSERT_TRUE(source->next(kPatience));
  EXPECT_EQ(source->statistics().drop(DropReason::kRefused), 1U);
  EXPECT_NE(source->condition().find("32 x 48"), std::string::npos) << source->condition();
}

TEST_F(PairedSourceTest, DamagedImagesAreCounted) {
  open();
  RawImage torn = image_of(PixelFormat::kZ16, kWidth, kHeight, 900, at(0), 0);
  torn.bytes = torn.bytes.first(100);
  depth->push(torn);
  depth->fail(std::make_exception_ptr(InputError("frame", "is damaged")));
  push_colour(33, 2, 1);
  push_depth(33, 1000, 1);
  ASSERT_TRUE(source->next(kPatience));
  // The scripted failure comes when the queue is empty: after the good one, or before it.
  while (source->statistics().drop(DropReason::kDamaged) < 2) EXPECT_FALSE(source->next(milliseconds(5)));
}

TEST_F(PairedSourceTest, OneStreamAloneGivesNothingAndEndsWithClose) {
  open();
  for (int i = 0; i < 20; ++i) push_colour(33 * i, 2, i);
  EXPECT_FALSE(source->next(milliseconds(20)));
  std::thread closer([&] { source->close(); });
  EXPECT_FALSE(source->next(kPatience));
  closer.join();
  EXPECT_EQ(source->state(), SourceState::kEnded);
}

TEST_F(PairedSourceTest, SaysWhichStreamIsWaitedFor) {
  open();
  depth->set_state(SourceState::kWaiting, "unplugged");
  EXPECT_EQ(source->state(), SourceState::kWaiting);
  EXPECT_EQ(source->condition(), "depth: unplugged");
}

TEST_F(PairedSourceTest, ADeadDeviceIsAnError) {
  open();
  depth->fail(std::make_exception_ptr(DeviceError("camera", "is broken")));
  EXPECT_THROW(source->next(kPatience), DeviceError);
}

TEST_F(PairedSourceTest, AddsUpWhatTheStreamsLost) {
  colour->own_statistics.drop(DropReason::kLost) = 3;
  depth->own_statistics.drop(DropReason::kLost) = 4;
  depth->own_statistics.reconnects = 2;
  open();
  EXPECT_EQ(source->statistics().drop(DropReason::kLost), 7U);
  EXPECT_EQ(source->statistics().reconnects, 2U);
}

TEST_F(PairedSourceTest, RefusesAnImpossibleCalibration) {
  options.calibration.colour.fx = 0;
  EXPECT_THROW(open(), InputError);
}

}  // namespace
}  // namespace sextant
