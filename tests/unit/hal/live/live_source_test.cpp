// SPDX-License-Identifier: Apache-2.0
// The life of a live stream, driven by scripted sessions: every kind of arrival, end and return.
#include "hal/live/live_source.h"

#include <gmock/gmock.h>

#include <atomic>
#include <deque>
#include <thread>

#include "hal/live/wake_event.h"

namespace sextant {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

/// A device under the test's control; outlives its sessions.
struct Device {
  std::deque<Arrival> arrivals;
  bool starved = false;
  bool absent = false;
  int opened = 0;
  std::uint32_t number = 0;
  WakeEvent event;

  Arrival& add(Arrival::Kind kind) {
    Arrival arrival;
    arrival.kind = kind;
    arrival.device_sequence = number++;
    arrival.device_time = read_clocks().monotonic.time_since_epoch();
    arrival.reason = "scripted";
    arrivals.push_back(arrival);
    event.set();
    return arrivals.back();
  }
  void image() { add(Arrival::Kind::kImage); }
};

class Session final : public StreamSession {
 public:
  explicit Session(Device& device) : device_(device) {}
  int wait_fd() const override { return device_.event.fd(); }
  bool is_starved() const override { return device_.starved; }
  std::string description() const override { return "scripted stream"; }
  Arrival take() override {
    if (device_.arrivals.empty()) {
      device_.event.clear();
      return {};
    }
    Arrival arrival = device_.arrivals.front();
    device_.arrivals.pop_front();
    return arrival;
  }

 private:
  Device& device_;
};

class LiveSource : public testing::Test {
 protected:
  std::unique_ptr<ImageSource> open() {
    return make_live_source("test", options_, [this] {
      ++device_.opened;
      if (device_.absent) throw DeviceUnready("test", "it is not there", "plug it in");
      return std::make_unique<Session>(device_);
    });
  }
  /// next() until the condition holds; false after a generous time.
  template <typename Condition>
  static bool eventually(ImageSource& source, Condition condition) {
    const auto end = std::chrono::steady_clock::now() + 20s;
    while (!condition() && std::chrono::steady_clock::now() < end) source.next(5ms);
    return condition();
  }

  Device device_;
  StreamOptions options_;
};

TEST_F(LiveSource, HandsOutTheNewestAndCountsTheRest) {
  const auto source = open();
  EXPECT_FALSE(source->next(0ms).has_value());
  EXPECT_EQ(source->state(), SourceState::kRunning);
  for (int i = 0; i < 3; ++i) device_.image();
  const auto image = source->next(1s);
  ASSERT_TRUE(image.has_value());
  EXPECT_EQ(image->sequence, 2);
  EXPECT_EQ(source->statistics().delivered, 1U);
  EXPECT_EQ(source->statistics().drop(DropReason::kSuperseded), 2U);
  EXPECT_EQ(source->condition(), "scripted stream");
}

TEST_F(LiveSource, HandsOutEveryOneWhereAsked) {
  options_.newest_only = false;
  const auto source = open();
  for (int i = 0; i < 3; ++i) device_.image();
  for (int i = 0; i < 3; ++i) EXPECT_EQ(source->next(1s)->sequence, i);
  EXPECT_EQ(source->statistics().dropped(), 0U);
}

TEST_F(LiveSource, CountsGapsAndDamage) {
  options_.newest_only = false;
  const auto source = open();
  device_.image();
  device_.number += 4;
  device_.add(Arrival::Kind::kDamaged);
  device_.image();
  EXPECT_EQ(source->next(1s)->sequence, 0);
  EXPECT_EQ(source->next(1s)->sequence, 6);
  EXPECT_EQ(source->statistics().drop(DropReason::kLost), 4U);
  EXPECT_EQ(source->statistics().drop(DropReason::kDamaged), 1U);
}

TEST_F(LiveSource, NeverHandsOutStaleOrUntimedImages) {
  options_.newest_only = false;
  const auto source = open();
  device_.add(Arrival::Kind::kImage).device_time -= 500ms;
  device_.add(Arrival::Kind::kImage).device_time = 0ns;
  device_.image();
  EXPECT_EQ(source->next(1s)->sequence, 2);
  EXPECT_EQ(source->statistics().drop(DropReason::kStale), 1U);
  EXPECT_EQ(source->statistics().drop(DropReason::kBadTime), 1U);
}

TEST_F(LiveSource, StampsBothClocks) {
  const auto source = open();
  device_.image();
  const auto stamp = device_.arrivals.back().device_time;
  const CaptureStamp before = read_clocks();
  const auto image = source->next(1s);
  EXPECT_EQ(image->captured.monotonic.time_since_epoch(), stamp);
  EXPECT_LE(image->captured.realtime, before.realtime + 1s);
  EXPECT_GE(image->captured.realtime, before.realtime - 1s);
}

TEST_F(LiveSource, OpensAnewWhatEnded) {
  const auto source = open();
  device_.image();
  ASSERT_TRUE(source->next(1s).has_value());
  device_.add(Arrival::Kind::kGone);
  device_.absent = true;
  EXPECT_TRUE(eventually(*source, [&] { return source->state() == SourceState::kWaiting; }));
  EXPECT_THAT(source->condition(), HasSubstr("scripted"));
  EXPECT_TRUE(eventually(*source, [&] { return device_.opened >= 4; }));
  EXPECT_THAT(source->condition(), HasSubstr("it is not there"));
  device_.absent = false;
  device_.number = 0;
  device_.arrivals.clear();
  std::optional<RawImage> image;
  EXPECT_TRUE(eventually(*source, [&] {
    device_.image();  // a fresh one at every try: the wait for the device may outlast an image's age
    if (!image) image = source->next(5ms);
    return image.has_value();
  }));
  EXPECT_GE(image->sequence, 1);  // goes on rising
  EXPECT_EQ(source->state(), SourceState::kRunning);
  EXPECT_EQ(source->statistics().reconnects, 1U);
  EXPECT_EQ(source->statistics().drop(DropReason::kLost), 0U);
}

TEST_F(LiveSource, TheWatchdogEndsASilentSession) {
  options_.watchdog = 50ms;
  const auto source = open();
  EXPECT_TRUE(eventually(*source, [&] { return source->state() == SourceState::kWaiting; }));
  EXPECT_THAT(source->condition(), HasSubstr("no good frame for 50 ms"));
  EXPECT_TRUE(eventually(*source, [&] { return device_.opened >= 3; }));
}

TEST_F(LiveSource, OnlyDamagedFramesAreSilenceToo) {
  options_.watchdog = 50ms;
  const auto source = open();
  EXPECT_TRUE(eventually(*source, [&] {
    device_.add(Arrival::Kind::kDamaged);
    return source->state() == SourceState::kWaiting;
  }));
}

TEST_F(LiveSource, AStarvedSessionIsNotSilent) {
  options_.watchdog = 50ms;
  device_.starved = true;
  const auto source = open();
  for (int i = 0; i < 4; ++i) EXPECT_FALSE(source->next(50ms).has_value());
  EXPECT_EQ(source->state(), SourceState::kRunning);
  EXPECT_EQ(device_.opened, 1);
}

TEST_F(LiveSource, AnAbsentDeviceIsTriedThriceOrWaitedFor) {
  device_.absent = true;
  EXPECT_THROW(open(), DeviceUnready);
  EXPECT_EQ(device_.opened, 3);
  options_.wait_for_device = true;
  const auto source = open();
  EXPECT_EQ(source->state(), SourceState::kWaiting);
  device_.absent = false;
  EXPECT_TRUE(eventually(*source, [&] {
    device_.image();
    return source->state() == SourceState::kRunning;
  }));
  EXPECT_EQ(source->statistics().reconnects, 0U);
}

TEST_F(LiveSource, AWrongRequestIsAnErrorAtOnce) {
  int tries = 0;
  EXPECT_THROW(make_live_source("test", options_,
                                [&]() -> std::unique_ptr<StreamSession> {
                                  ++tries;
                                  throw DeviceError("test", "no such format");
                                }),
               DeviceError);
  EXPECT_EQ(tries, 1);
}

TEST_F(LiveSource, CloseEndsEveryWait) {
  for (const bool absent : {false, true}) {
    options_.watchdog = 10min;
    const auto source = open();
    device_.absent = absent;
    if (absent) device_.add(Arrival::Kind::kGone);
    std::atomic<bool> waits = false;
    std::thread closer([&] {
      while (!waits) std::this_thread::yield();
      source->close();
    });
    waits = true;
    while (source->state() != SourceState::kEnded) source->next(10min);
    closer.join();
    EXPECT_FALSE(source->next(10min).has_value());
    device_.absent = false;
  }
}

}  // namespace
}  // namespace sextant
