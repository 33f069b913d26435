// SPDX-License-Identifier: Apache-2.0
#include "hal/live/device_clock.h"

#include <algorithm>

namespace sextant {
namespace {

using std::chrono::nanoseconds;

constexpr int kWindow = 128;
/// Transport delays vary by less than this; a "clock" that does not run varies more.
constexpr nanoseconds kLargestSpread = std::chrono::milliseconds(200);

bool is_plausible(nanoseconds stamp, MonotonicTime arrival) {
  const nanoseconds age = arrival.time_since_epoch() - stamp;
  return stamp.count() > 0 && age >= -DeviceClock::kEarliest && age <= DeviceClock::kOldest;
}

}  // namespace

void DeviceClock::begin_measuring() {
  measured_ = 0;
  in_window_ = 0;
  smallest_ = previous_smallest_ = nanoseconds::max();
  largest_ = nanoseconds::min();
}

/// The smallest difference of arrival and stamp is the one with the least delay. Two windows, so that it can
/// grow again when the device's clock runs slow.
void DeviceClock::measure(nanoseconds offset) {
  smallest_ = std::min(smallest_, offset);
  largest_ = std::max(largest_, offset);
  if (measured_ < kMeasuredFrames) ++measured_;
  if (++in_window_ < kWindow) return;
  previous_smallest_ = smallest_;
  smallest_ = nanoseconds::max();
  in_window_ = 0;
}

std::optional<MonotonicTime> DeviceClock::capture_time(nanoseconds stamp, MonotonicTime arrival) {
  if (is_plausible(stamp, arrival)) {
    foreign_ = false;
    return std::min(MonotonicTime(stamp), arrival);
  }
  if (!foreign_) begin_measuring();
  foreign_ = true;
  const nanoseconds offset = arrival.time_since_epoch() - stamp;
  if (measured_ >= kMeasuredFrames) {
    const nanoseconds jump = offset - std::min(smallest_, previous_smallest_);
    if (jump > kOldest || jump < -kOldest) begin_measuring();  // the clock jumped
  }
  const bool was_measured = measured_ >= kMeasuredFrames;
  measure(offset);
  if (!was_measured) {
    if (largest_ - smallest_ > kLargestSpread) begin_measuring();
    return std::nullopt;
  }
  return MonotonicTime(stamp + std::min(smallest_, previous_smallest_));
}

}  // namespace sextant
