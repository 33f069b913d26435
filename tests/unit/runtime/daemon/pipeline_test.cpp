// SPDX-License-Identifier: Apache-2.0
#include "runtime/daemon/pipeline.h"

#include <gmock/gmock.h>

#include <atomic>
#include <stdexcept>
#include <thread>

#include "runtime/base/error.h"
#include "runtime/daemon/newest_queue.h"
#include "tests/unit/runtime/daemon/scripted_source.h"

namespace sextant {
namespace {

using namespace std::chrono_literals;

constexpr auto kPatience = 20s;

/// Publishes into a list.
struct Collector {
  std::mutex mutex;
  std::vector<std::int64_t> published;
  std::vector<FrameReport> reports;

  PublishFunction publish() {
    return [this](const FrameResult& result, const RgbdFrame& frame) {
      EXPECT_EQ(frame.sequence, result.sequence);
      const std::lock_guard lock(mutex);
      published.push_back(result.sequence);
    };
  }
  std::function<void(const FrameReport&)> report() {
    return [this](const FrameReport& report) {
      const std::lock_guard lock(mutex);
      reports.push_back(report);
    };
  }
};

TEST(NewestQueue, DropsTheOldestAndCounts) {
  NewestQueue<RgbdFrame> queue(2);
  for (int i = 0; i < 5; ++i) {
    RgbdFrame frame;
    frame.sequence = i;
    queue.push(frame);
  }
  EXPECT_EQ(queue.dropped(), 3U);
  EXPECT_EQ(queue.pop()->sequence, 3);
  EXPECT_EQ(queue.pop()->sequence, 4);
  queue.push({});
  queue.end();
  queue.push({});  // after the end: ignored
  EXPECT_TRUE(queue.pop().has_value());
  EXPECT_FALSE(queue.pop().has_value());
  EXPECT_FALSE(queue.wait_for_demand());
}

TEST(NewestQueue, AbortForgetsWhatWaitsAndWakesEverybody) {
  NewestQueue<RgbdFrame> queue(2);
  queue.push({});
  std::thread producer([&] { EXPECT_FALSE(queue.wait_for_demand()); });
  queue.abort();
  producer.join();
  EXPECT_FALSE(queue.pop().has_value());
}

TEST(Pipeline, UnpacedPlaybackSkipsNoFrame) {
  ScriptedSource source(30);
  Collector out;
  PipelineOptions options;
  options.skip_none = true;
  options.max_age_ms = 60000;
  const auto slow = [](const RgbdFrame& frame) {
    std::this_thread::sleep_for(2ms);
    return empty_result(frame);
  };
  const Pipeline pipeline(source, slow, out.publish(), options, out.report());
  ASSERT_TRUE(pipeline.wait(kPatience));
  pipeline.rethrow_error();
  std::vector<std::int64_t> all(30);
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<std::int64_t>(i);
  EXPECT_EQ(out.published, all);
  EXPECT_EQ(pipeline.statistics().dropped, 0U);
}

TEST(Pipeline, APacedSourceLosesTheOldestWhenDetectionIsLate) {
  std::atomic<int> delivered = 0;
  ScriptedSource source(10, [&](RgbdFrame&) { ++delivered; });
  Collector out;
  PipelineOptions options;
  options.queue_frames = 2;
  options.max_age_ms = 60000;
  // The first detection lasts until all frames are there.
  const auto detect = [&](const RgbdFrame& frame) {
    while (delivered < 10) std::this_thread::sleep_for(1ms);
    std::this_thread::sleep_for(50ms);
    return empty_result(frame);
  };
  const Pipeline pipeline(source, detect, out.publish(), options, out.report());
  ASSERT_TRUE(pipeline.wait(kPatience));
  const PipelineStatistics counts = pipeline.statistics();
  EXPECT_EQ(counts.published + counts.dropped, 10U);
  EXPECT_GE(counts.dropped, 6U);
  ASSERT_GE(out.published.size(), 2U);
  EXPECT_EQ(out.published.back(), 9);  // never the newest
  EXPECT_EQ(out.published[out.published.size() - 2], 8);
  EXPECT_TRUE(std::is_sorted(out.published.begin(), out.published.end()));
}

TEST(Pipeline, OldResultsAreCountedAndNeverPublished) {
  ScriptedSource source(6, [](RgbdFrame& frame) {
    if (frame.sequence % 2 == 1) shift_capture(frame, -10s);
  });
  Collector out;
  PipelineOptions options;
  options.skip_none = true;
  options.max_age_ms = 5000;
  const Pipeline pipeline(source, empty_result, out.publish(), options, out.report());
  ASSERT_TRUE(pipeline.wait(kPatience));
  EXPECT_THAT(out.published, testing::ElementsAre(0, 2, 4));
  EXPECT_EQ(pipeline.statistics().too_old, 3U);
  EXPECT_EQ(out.reports[1].fate, FrameFate::kTooOld);
  EXPECT_GE(out.reports[1].age_ms, 10000);
}

TEST(Pipeline, StaleFramesAreNeverSearched) {
  ScriptedSource source(6, [](RgbdFrame& frame) {
    if (frame.sequence % 2 == 1) shift_capture(frame, -10s);
    // A wall clock that was set since makes no frame stale.
    if (frame.sequence == 2) frame.captured_at -= 10s;
  });
  Collector out;
  PipelineOptions options;
  options.skip_none = true;
  options.max_age_ms = 60000;
  options.max_frame_age_ms = 5000;
  std::vector<std::int64_t> searched;
  const auto detect = [&](const RgbdFrame& frame) {
    searched.push_back(frame.sequence);
    return empty_result(frame);
  };
  const Pipeline pipeline(source, detect, out.publish(), options, out.report());
  ASSERT_TRUE(pipeline.wait(kPatience));
  EXPECT_THAT(searched, testing::ElementsAre(0, 2, 4));
  EXPECT_THAT(out.published, testing::ElementsAre(0, 2, 4));
  EXPECT_EQ(pipeline.statistics().stale, 3U);
  // Stages overlap: reports of frames that are dropped may come before those of earlier frames.
  const auto stale = std::find_if(out.reports.begin(), out.reports.end(),
                                  [](const auto& report) { return report.fate == FrameFate::kStale; });
  ASSERT_NE(stale, out.reports.end());
  EXPECT_GE(stale->age_ms, 10000);
}

TEST(Pipeline, BadFramesAreCountedAndPassedOver) {
  ScriptedSource source(8, [](RgbdFrame& frame) {
    if (frame.sequence == 1) throw InputError("picture.png", "it is damaged", "replace it");
    if (frame.sequence == 2) frame.captured_at = {};
    if (frame.sequence == 3) shift_capture(frame, 1h);
  });
  Collector out;
  PipelineOptions options;
  options.skip_none = true;
  options.max_age_ms = 60000;
  const auto detect = [](const RgbdFrame& frame) {
    if (frame.sequence == 4) throw InputError("image 4", "no table", "look at the table");
    if (frame.sequence == 5) throw std::logic_error("our bug");
    return empty_result(frame);
  };
  const Pipeline pipeline(source, detect, out.publish(), options, out.report());
  ASSERT_TRUE(pipeline.wait(kPatience));
  pipeline.rethrow_error();
  EXPECT_THAT(out.published, testing::ElementsAre(0, 6, 7));
  EXPECT_EQ(pipeline.statistics().failed, 5U);
  std::vector<std::string> reasons;
  for (const FrameReport& report : out.reports) reasons.push_back(report.reason);
  EXPECT_THAT(reasons, testing::Contains(testing::HasSubstr("damaged")));
  EXPECT_THAT(reasons, testing::Contains(testing::HasSubstr("no capture time")));
  EXPECT_THAT(reasons, testing::Contains(testing::HasSubstr("future")));
  EXPECT_THAT(reasons, testing::Contains(testing::HasSubstr("our bug")));
}

TEST(Pipeline, ADeadDeviceEndsIt) {
  ScriptedSource source(1000000, [](RgbdFrame& frame) {
    if (frame.sequence == 3) throw DeviceError("camera", "it was unplugged", "plug it in");
  });
  Collector out;
  const Pipeline pipeline(source, empty_result, out.publish(), {}, out.report());
  ASSERT_TRUE(pipeline.wait(kPatience));
  EXPECT_THROW(pipeline.rethrow_error(), DeviceError);
}

TEST(Pipeline, ADeadNetworkEndsIt) {
  ScriptedSource source(1);
  source.run_forever();
  Collector out;
  const Pipeline pipeline(
      source, empty_result,
      [](const FrameResult&, const RgbdFrame&) { throw DeviceError("DDS", "write", ""); }, {}, out.report());
  ASSERT_TRUE(pipeline.wait(kPatience));
  EXPECT_THROW(pipeline.rethrow_error(), DeviceError);
}

TEST(Pipeline, OnceEndsAfterOneFrame) {
  ScriptedSource source(100);
  Collector out;
  PipelineOptions options;
  options.once = true;
  options.max_age_ms = 60000;
  const Pipeline pipeline(source, empty_result, out.publish(), options, out.report());
  ASSERT_TRUE(pipeline.wait(kPatience));
  pipeline.rethrow_error();
  EXPECT_THAT(out.published, testing::ElementsAre(0));
}

TEST(Pipeline, OnceTellsWhatWasWrong) {
  PipelineOptions options;
  options.once = true;
  const auto run = [&](const ScriptedSource::Step& step) {
    ScriptedSource source(100, step);
    Collector out;
    const Pipeline pipeline(source, empty_result, out.publish(), options, out.report());
    EXPECT_TRUE(pipeline.wait(kPatience));
    EXPECT_THAT(out.published, testing::IsEmpty());
    pipeline.rethrow_error();
  };
  EXPECT_THROW(run([](RgbdFrame&) { throw InputError("picture.png", "damaged"); }), InputError);
  EXPECT_THROW(run([](RgbdFrame& frame) { shift_capture(frame, -1h); }), InputError);
  EXPECT_THROW(run([](RgbdFrame& frame) { frame.captured_at = {}; }), InputError);
}

TEST(Pipeline, NothingIsPublishedAfterStop) {
  for (int round = 0; round < 20; ++round) {
    ScriptedSource source(1000000);
    std::atomic<bool> stopped = false;
    std::atomic<int> late = 0;
    std::atomic<int> published = 0;
    Pipeline pipeline(
        source, empty_result,
        [&](const FrameResult&, const RgbdFrame&) {
          ++published;
          if (stopped) ++late;
        },
        {}, [](const FrameReport&) {});
    while (published < 3) std::this_thread::yield();
    pipeline.stop();
    stopped = true;
    ASSERT_TRUE(pipeline.wait(kPatience));
    EXPECT_EQ(late, 0);
  }
}

TEST(Pipeline, StopDoesNotWaitForADetectionAndItsResultIsLost) {
  ScriptedSource source(1000000);
  std::atomic<bool> detecting = false;
  std::atomic<bool> let_go = false;
  Collector out;
  Pipeline pipeline(
      source,
      [&](const RgbdFrame& frame) {
        detecting = true;
        while (!let_go) std::this_thread::sleep_for(1ms);
        return empty_result(frame);
      },
      out.publish(), {}, out.report());
  while (!detecting) std::this_thread::sleep_for(1ms);
  pipeline.stop();
  EXPECT_FALSE(pipeline.wait(0ms));
  let_go = true;
  EXPECT_TRUE(pipeline.wait(kPatience));
  EXPECT_THAT(out.published, testing::IsEmpty());
}

}  // namespace
}  // namespace sextant
