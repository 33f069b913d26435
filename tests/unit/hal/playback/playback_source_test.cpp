// SPDX-License-Identifier: Apache-2.0
#include "hal/playback/playback_source.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "runtime/base/error.h"
#include "tests/support/small_bop.h"
#include "tests/support/temporary_folder.h"

namespace sextant {
namespace {

using namespace std::chrono_literals;

class PlaybackSource : public testing::Test {
 protected:
  PlaybackSource() {
    write_small_bop(folder_.path());
    options_.dataset = folder_.path();
    options_.frame_id = "camera";
  }
  TemporaryFolder folder_;
  PlaybackOptions options_;
};

TEST_F(PlaybackSource, PlaysEveryImageOnceInOrder) {
  const auto source = open_playback(options_);
  std::vector<std::pair<std::int64_t, std::int64_t>> order;
  CaptureTime last = std::chrono::system_clock::now();
  while (source->state() == SourceState::kRunning) {
    const auto frame = source->next(1s);
    ASSERT_TRUE(frame.has_value());
    EXPECT_EQ(static_cast<std::int64_t>(order.size()), frame->sequence);
    EXPECT_EQ("camera", frame->frame_id);
    EXPECT_GE(frame->captured_at, last);
    last = frame->captured_at;
    order.emplace_back(frame->scene_id, frame->image_id);
  }
  EXPECT_LE(last, std::chrono::system_clock::now());
  EXPECT_THAT(order,
              testing::ElementsAre(std::pair(1, 2), std::pair(1, 11), std::pair(10, 2), std::pair(10, 11)));
  EXPECT_FALSE(source->next(1ms).has_value());
  EXPECT_EQ(4U, source->statistics().delivered);
  EXPECT_EQ(0U, source->statistics().dropped());
}

TEST_F(PlaybackSource, SelectsSceneAndImage) {
  options_.scene = 10;
  options_.image = 11;
  const auto source = open_playback(options_);
  EXPECT_EQ(10, source->next(1s)->scene_id);
  EXPECT_EQ(SourceState::kEnded, source->state());
  options_.image = 3;
  EXPECT_THROW(open_playback(options_), InputError);
  options_.rate_hz = -1;
  EXPECT_THROW(open_playback(options_), UsageError);
}

TEST_F(PlaybackSource, LoopsWithRisingSequence) {
  options_.loop = true;
  const auto source = open_playback(options_);
  for (std::int64_t i = 0; i < 11; ++i) {
    const auto frame = source->next(1s);
    ASSERT_TRUE(frame.has_value());
    EXPECT_EQ(i, frame->sequence);
    EXPECT_EQ(i % 2 ? 11 : 2, frame->image_id);
  }
  EXPECT_EQ(SourceState::kRunning, source->state());
}

TEST_F(PlaybackSource, KeepsTheRateAndTheTimeout) {
  options_.rate_hz = 50;
  const auto source = open_playback(options_);
  const CaptureTime first = source->next(1s)->captured_at;
  // Not due yet: nothing, and nothing is lost by asking early.
  EXPECT_FALSE(source->next(0ms).has_value());
  EXPECT_EQ(SourceState::kRunning, source->state());
  const CaptureTime second = source->next(10s)->captured_at;
  EXPECT_GE(second - first, 19ms);
  EXPECT_EQ(2U, source->statistics().delivered);
}

TEST_F(PlaybackSource, CloseWakesAWaitingReader) {
  options_.rate_hz = 0.001;
  const auto source = open_playback(options_);
  ASSERT_TRUE(source->next(1s).has_value());
  std::thread closer([&] {
    std::this_thread::sleep_for(20ms);
    source->close();
  });
  // Would wait for 1000 s.
  EXPECT_FALSE(source->next(std::chrono::hours(1)).has_value());
  closer.join();
  EXPECT_EQ(SourceState::kEnded, source->state());
  EXPECT_FALSE(source->next(1s).has_value());
}

TEST_F(PlaybackSource, ABadImageIsAnErrorAndTheNextOnePlays) {
  write_text(folder_ / "test/000001/rgb/000011.png", "damaged");
  const auto source = open_playback(options_);
  EXPECT_EQ(2, source->next(1s)->image_id);
  EXPECT_THROW(source->next(1s), InputError);
  EXPECT_EQ(10, source->next(1s)->scene_id);
  EXPECT_EQ(1U, source->statistics().dropped());
  write_text(folder_ / "test/000010/rgb/000011.png", "damaged");
  EXPECT_THROW(source->next(1s), InputError);
  EXPECT_EQ(SourceState::kEnded, source->state());
}

}  // namespace
}  // namespace sextant
