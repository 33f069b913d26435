// SPDX-License-Identifier: Apache-2.0
// Pacing on a clock that jumps to where playback waits for: no test waits.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "hal/playback/playback_source.h"
#include "hal/playback/recording_format.h"
#include "runtime/base/error.h"
#include "tests/support/small_bop.h"
#include "tests/support/temporary_folder.h"

namespace sextant {
namespace {

using namespace std::chrono_literals;

class JumpingClock final : public PlaybackClock {
 public:
  Time time{std::chrono::hours(100)};
  Time now() override { return time; }
  void wait(std::unique_lock<std::mutex>&, std::condition_variable&, Time until,
            const std::function<bool()>&) override {
    time = std::max(time, until);
  }
};

/// A recording of 32 x 24 frames captured at these milliseconds.
void write_recording(const std::filesystem::path& folder, const std::vector<int>& captured_ms) {
  std::string lines = recording_header();
  int image = 0;
  for (const int ms : captured_ms) {
    write_small_image(folder / "test/000001", 1, image);
    RecordedFrame r;
    r.image_id = image++;
    r.depth_scale_mm = 0.5;
    r.frame.camera = {.width = 32, .height = 24, .fx = 30, .fy = 31, .cx = 15, .cy = 11};
    r.frame.sequence = 100 + ms;
    r.frame.captured_at = CaptureTime(std::chrono::hours(500000) + std::chrono::milliseconds(ms));
    r.frame.captured_monotonic = MonotonicTime(std::chrono::hours(3) + std::chrono::milliseconds(ms));
    r.frame.frame_id = "recorded";
    lines += line_of(r);
  }
  lines += line_of(RecordingEnd{captured_ms.size(), 0, 0, 0});
  write_text(folder / "test/000001/frames.jsonl", lines);
}

class PlaybackPace : public testing::Test {
 protected:
  PlaybackPace() {
    options_.dataset = folder_.path();
    options_.clock = clock_;
    options_.pace = sextant::PlaybackPace::kTimestamps;
  }
  /// Milliseconds of the clock between the frames.
  std::vector<int> intervals(int frames) {
    const auto source = open_playback(options_);
    std::vector<int> out;
    PlaybackClock::Time last{};
    for (int i = 0; i < frames; ++i) {
      if (!source->next(std::chrono::hours(10))) break;
      if (i > 0)
        out.push_back(
            static_cast<int>(std::chrono::round<std::chrono::milliseconds>(clock_->time - last).count()));
      last = clock_->time;
    }
    return out;
  }
  TemporaryFolder folder_;
  std::shared_ptr<JumpingClock> clock_ = std::make_shared<JumpingClock>();
  PlaybackOptions options_;
};

TEST_F(PlaybackPace, AsItWasCaptured) {
  write_recording(folder_.path(), {0, 33, 66, 200, 233});
  EXPECT_THAT(intervals(9), testing::ElementsAre(33, 33, 134, 33));
}

TEST_F(PlaybackPace, TwiceAsFastAndInALoop) {
  write_recording(folder_.path(), {0, 40, 100});
  options_.speed = 2;
  options_.loop = true;
  EXPECT_THAT(intervals(6), testing::ElementsAre(20, 30, 20, 20, 30));
}

TEST_F(PlaybackPace, ByRateWhateverTheRecordingSays) {
  write_recording(folder_.path(), {0, 40, 100});
  options_.pace = sextant::PlaybackPace::kRate;
  options_.rate_hz = 10;
  EXPECT_THAT(intervals(9), testing::ElementsAre(100, 100));
  options_.rate_hz = 0;
  EXPECT_THAT(intervals(9), testing::ElementsAre(0, 0));
}

TEST_F(PlaybackPace, AClockSetBackInTheRecordingIsNoPause) {
  write_recording(folder_.path(), {1000, 1033, 0, 33});
  EXPECT_THAT(intervals(9), testing::ElementsAre(33, 0, 33));
}

TEST_F(PlaybackPace, ALateConsumerGetsTheNextAtOnceAndANewBeat) {
  write_recording(folder_.path(), {0, 30, 60, 90});
  const auto source = open_playback(options_);
  ASSERT_TRUE(source->next(1s));
  clock_->time += 500ms;
  ASSERT_TRUE(source->next(0ms));
  EXPECT_FALSE(source->next(0ms));
  const PlaybackClock::Time before = clock_->time;
  ASSERT_TRUE(source->next(1s));
  EXPECT_EQ(clock_->time - before, 30ms);
}

TEST_F(PlaybackPace, RestampsOrKeepsWhatWasRecorded) {
  write_recording(folder_.path(), {0, 30});
  options_.restamp = false;
  auto frame = open_playback(options_)->next(1s);
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->sequence, 100);
  EXPECT_EQ(frame->captured_at, CaptureTime(std::chrono::hours(500000)));
  EXPECT_EQ(frame->captured_monotonic, MonotonicTime(std::chrono::hours(3)));
  EXPECT_EQ(frame->frame_id, "recorded");
  options_.restamp = true;
  options_.frame_id = "other";
  frame = open_playback(options_)->next(1s);
  EXPECT_EQ(frame->sequence, 0);
  EXPECT_GT(frame->captured_at, CaptureTime(std::chrono::hours(420000)));
  EXPECT_EQ(frame->frame_id, "other");
}

TEST_F(PlaybackPace, NeedsTimesToPlayBy) {
  write_small_bop(folder_.path());
  EXPECT_THROW(open_playback(options_), UsageError);
  options_.pace = sextant::PlaybackPace::kRate;
  options_.speed = 0;
  EXPECT_THROW(open_playback(options_), UsageError);
}

}  // namespace
}  // namespace sextant
