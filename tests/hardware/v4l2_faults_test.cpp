// SPDX-License-Identifier: Apache-2.0
// Every fault that a driver can make, on the kernel's own driver: survived, counted, and documented.
#include <gmock/gmock.h>

#include <fstream>

#include "hal/v4l2/v4l2_source.h"
#include "runtime/base/error.h"
#include "tests/hardware/vivid.h"

namespace sextant {
namespace {

using namespace std::chrono_literals;
using vivid::next_image;

class V4l2Faults : public testing::Test {
 protected:
  void SetUp() override {
    source_ = open_v4l2_source(vivid::webcam());
    ASSERT_TRUE(next_image(*source_).has_value());
  }
  std::uint64_t drops(DropReason reason) const { return source_->statistics().drop(reason); }

  /// Frames go on, with rising numbers and times.
  void expect_good_frames(int count = 3) {
    std::int64_t last_sequence = -1;
    MonotonicTime last_time{};
    for (int i = 0; i < count; ++i) {
      const auto image = next_image(*source_);
      ASSERT_TRUE(image.has_value()) << source_->condition();
      EXPECT_GT(image->sequence, last_sequence);
      EXPECT_GT(image->captured.monotonic, last_time);
      EXPECT_LE(image->captured.monotonic, std::chrono::steady_clock::now());
      EXPECT_EQ(image->bytes.size(), 640U * 480 * 2);
      last_sequence = image->sequence;
      last_time = image->captured.monotonic;
    }
    EXPECT_EQ(source_->state(), SourceState::kRunning);
  }

  std::unique_ptr<ImageSource> source_;
};

TEST_F(V4l2Faults, AnErrorFlagIsADamagedFrame) {
  vivid::control(vivid::kWebcamNode, "inject_v4l2_buf_flag_error=1");
  for (int i = 0; i < 200 && drops(DropReason::kDamaged) == 0; ++i) source_->next(100ms);
  EXPECT_EQ(drops(DropReason::kDamaged), 1U);
  expect_good_frames();
  EXPECT_EQ(source_->statistics().reconnects, 0U);
}

TEST_F(V4l2Faults, AFatalQueueErrorOpensTheStreamAnew) {
  vivid::control(vivid::kWebcamNode, "inject_fatal_streaming_error=1");
  EXPECT_TRUE(vivid::reaches(*source_, SourceState::kWaiting));
  EXPECT_THAT(source_->condition(), testing::HasSubstr("opening it anew"));
  expect_good_frames();
  EXPECT_EQ(source_->statistics().reconnects, 1U);
}

TEST_F(V4l2Faults, DroppedFramesAreCountedAsLost) {
  vivid::control(vivid::kWebcamNode, "percentage_of_dropped_buffers=50");
  for (int i = 0; i < 400 && drops(DropReason::kLost) < 5; ++i) source_->next(100ms);
  vivid::control(vivid::kWebcamNode, "percentage_of_dropped_buffers=0");
  EXPECT_GE(drops(DropReason::kLost), 5U);
  expect_good_frames();
}

TEST_F(V4l2Faults, SilenceIsNoticedByTheWatchdog) {
  vivid::control(vivid::kWebcamNode, "percentage_of_dropped_buffers=100");
  EXPECT_TRUE(vivid::reaches(*source_, SourceState::kWaiting));
  EXPECT_THAT(source_->condition(), testing::HasSubstr("no good frame"));
  vivid::control(vivid::kWebcamNode, "percentage_of_dropped_buffers=0");
  expect_good_frames();
  EXPECT_GE(source_->statistics().reconnects, 1U);
}

TEST_F(V4l2Faults, NumbersThatWrapLoseNothing) {
  source_.reset();
  vivid::control(vivid::kWebcamNode, "wrap_sequence_number=1");
  source_ = open_v4l2_source(vivid::webcam());
  // The driver begins 128 frames before the wrap.
  std::int64_t last = -1;
  for (int i = 0; i < 400 && last < 160; ++i) {
    if (const auto image = source_->next(1s)) {
      EXPECT_GT(image->sequence, last);
      last = image->sequence;
    }
  }
  vivid::control(vivid::kWebcamNode, "wrap_sequence_number=0");
  EXPECT_GE(last, 160);
  const SourceStatistics counts = source_->statistics();
  EXPECT_EQ(counts.delivered + counts.dropped(), static_cast<std::uint64_t>(last) + 1);
}

TEST_F(V4l2Faults, ATimeThatWrapsIsMeasuredAnew) {
  vivid::control(vivid::kWebcamNode, "wrap_timestamp=1");
  expect_good_frames(12);
  vivid::control(vivid::kWebcamNode, "wrap_timestamp=0");
  expect_good_frames(3);
  EXPECT_EQ(source_->statistics().reconnects, 0U);
}

TEST_F(V4l2Faults, ADisconnectedDeviceIsWaitedFor) {
  vivid::control(vivid::kWebcamNode, "disconnect=1");
  EXPECT_TRUE(vivid::reaches(*source_, SourceState::kWaiting));
  expect_good_frames();
  EXPECT_EQ(source_->statistics().reconnects, 1U);
}

TEST_F(V4l2Faults, UnpluggedAndPluggedInAgain) {
  for (int round = 1; round <= 2; ++round) {
    vivid::unplug();
    EXPECT_TRUE(vivid::reaches(*source_, SourceState::kWaiting));
    // Away for longer than the longest pause between two tries.
    const auto until = std::chrono::steady_clock::now() + 1s;
    while (std::chrono::steady_clock::now() < until) EXPECT_FALSE(source_->next(50ms).has_value());
    EXPECT_THAT(source_->condition(), testing::HasSubstr("no such V4L2 camera"));
    vivid::plug();
    const auto back = std::chrono::steady_clock::now();
    expect_good_frames();
    const std::chrono::duration<double> recovery = std::chrono::steady_clock::now() - back;
    printf("recovery %d: %.2f s after the driver was bound\n", round, recovery.count());
    EXPECT_EQ(source_->statistics().reconnects, static_cast<std::uint64_t>(round));
  }
}

TEST_F(V4l2Faults, AnAbsentDeviceDelaysNoEnd) {
  vivid::unplug();
  EXPECT_TRUE(vivid::reaches(*source_, SourceState::kWaiting));
  std::thread closer([&] { source_->close(); });
  while (source_->state() != SourceState::kEnded) source_->next(10s);
  closer.join();
  EXPECT_FALSE(source_->next(10s).has_value());
  vivid::plug();
}

TEST(V4l2FirstOpen, OneFailingStepIsTriedAgain) {
  for (const char* fault :
       {"inject_vidioc_reqbufs_error=1", "inject_vidioc_qbuf_error=1", "inject_vidioc_streamon_error=1"}) {
    vivid::control(vivid::kWebcamNode, fault);
    const auto source = open_v4l2_source(vivid::webcam());
    EXPECT_TRUE(next_image(*source).has_value()) << fault;
  }
}

TEST(V4l2FirstOpen, AnAbsentDeviceIsAnErrorOrWaitedFor) {
  StreamOptions options = vivid::webcam();
  vivid::unplug();
  EXPECT_THROW(open_v4l2_source(options), DeviceError);
  options.wait_for_device = true;
  const auto source = open_v4l2_source(options);
  EXPECT_EQ(source->state(), SourceState::kWaiting);
  EXPECT_FALSE(source->next(10ms).has_value());
  vivid::plug();
  EXPECT_TRUE(next_image(*source).has_value());
  EXPECT_EQ(source->statistics().reconnects, 0U);
}

}  // namespace
}  // namespace sextant
