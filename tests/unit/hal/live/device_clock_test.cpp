// SPDX-License-Identifier: Apache-2.0
// Clocks that are monotonic time, clocks that are not, and clocks that jump.
#include "hal/live/device_clock.h"

#include <gtest/gtest.h>

#include <random>

namespace sextant {
namespace {

using namespace std::chrono_literals;
using std::chrono::nanoseconds;

constexpr nanoseconds kPeriod = 33333333ns;

MonotonicTime at(nanoseconds since_boot) { return MonotonicTime(since_boot); }

TEST(DeviceClock, TakesMonotonicTimeAsItIs) {
  DeviceClock clock;
  for (int i = 0; i < 100; ++i) {
    const nanoseconds captured = 1000s + i * kPeriod;
    EXPECT_EQ(clock.capture_time(captured, at(captured + 20ms)), at(captured));
  }
  EXPECT_FALSE(clock.is_foreign());
}

TEST(DeviceClock, MeasuresAForeignClock) {
  DeviceClock clock;
  std::mt19937_64 random(3);
  int without = 0;
  for (int i = 0; i < 1000; ++i) {
    const nanoseconds captured = 1000s + i * kPeriod;
    const nanoseconds delay = 5ms + nanoseconds(random() % 20'000'000);
    const auto time = clock.capture_time(captured - 990s, at(captured + delay));
    if (!time) {
      ++without;
      continue;
    }
    // Late by the least delay, never before the capture, never after the arrival.
    EXPECT_GE(*time, at(captured));
    EXPECT_LE(*time, at(captured + delay));
    EXPECT_LE(*time, at(captured + 5ms + 6ms));
  }
  EXPECT_EQ(without, DeviceClock::kMeasuredFrames);
  EXPECT_TRUE(clock.is_foreign());
}

TEST(DeviceClock, FollowsAClockThatRunsSlow) {
  DeviceClock clock;
  // 200 ppm: 0.7 s within the hour, which would make every frame stale.
  for (int i = 0; i < 108000; ++i) {
    const nanoseconds captured = 1000s + i * kPeriod;
    const auto stamp =
        nanoseconds(static_cast<std::int64_t>(static_cast<double>((i * kPeriod).count()) * 0.9998));
    const auto time = clock.capture_time(stamp, at(captured + 10ms));
    if (i < DeviceClock::kMeasuredFrames) continue;
    ASSERT_TRUE(time.has_value());
    EXPECT_GE(*time, at(captured));
    EXPECT_LE(*time, at(captured + 20ms));
  }
}

TEST(DeviceClock, MeasuresAnewAfterAJump) {
  DeviceClock clock;
  nanoseconds captured = 5000s;
  int without = 0;
  const auto run = [&](nanoseconds offset) {
    for (int i = 0; i < 30; ++i) {
      captured += kPeriod;
      const auto time = clock.capture_time(captured + offset, at(captured + 8ms));
      if (!time) {
        ++without;
      } else {
        EXPECT_GE(*time, at(captured));
        EXPECT_LE(*time, at(captured + 8ms));
      }
    }
  };
  run(0ns);
  EXPECT_EQ(without, 0);
  run(2147483648s);  // the seconds are about to wrap
  EXPECT_EQ(without, DeviceClock::kMeasuredFrames);
  run(-4000s);  // they have
  EXPECT_EQ(without, 2 * DeviceClock::kMeasuredFrames);
  run(0ns);  // true again
  EXPECT_EQ(without, 2 * DeviceClock::kMeasuredFrames);
  EXPECT_FALSE(clock.is_foreign());
}

TEST(DeviceClock, NeverBelievesAClockThatStands) {
  DeviceClock clock;
  for (int i = 0; i < 300; ++i) EXPECT_FALSE(clock.capture_time(0ns, at(100s + i * kPeriod)).has_value());
}

TEST(DeviceClock, NoTimeInTheFuture) {
  DeviceClock clock;
  // The end of a read-out that the driver expects: captured when it arrived, at the latest.
  EXPECT_EQ(clock.capture_time(100s + 36ms, at(100s)), at(100s));
  EXPECT_FALSE(clock.is_foreign());
  EXPECT_FALSE(clock.capture_time(100s + 500ms, at(100s)).has_value());
}

}  // namespace
}  // namespace sextant
