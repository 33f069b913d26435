// SPDX-License-Identifier: Apache-2.0
// The capture time of a frame from what its device says. Most drivers stamp CLOCK_MONOTONIC; some count on a
// clock of their own, and some jump (a 32-bit second counter that wraps). A stamp that cannot be monotonic
// time is mapped by an offset that is measured, never replaced by "now".
#pragma once

#include <chrono>
#include <optional>

#include "runtime/frame/capture_time.h"

namespace sextant {

/// One stream's clock.
class DeviceClock {
 public:
  /// Frames from which an offset is measured; they have no time yet.
  static constexpr int kMeasuredFrames = 8;
  /// A stamp older than this at its arrival is no monotonic time of this frame.
  static constexpr std::chrono::nanoseconds kOldest = std::chrono::seconds(1);
  /// A stamp may be this far ahead of its arrival: some drivers say when the frame would have been read out.
  /// It was captured before it arrived all the same.
  static constexpr std::chrono::nanoseconds kEarliest = std::chrono::milliseconds(100);

  /// When the frame was captured, or nothing while the offset of a foreign clock is being measured. `stamp`
  /// is the device's time in nanoseconds, `arrival` when the frame could be had. With an offset the result is
  /// late by the least transport delay of the last 256 frames.
  std::optional<MonotonicTime> capture_time(std::chrono::nanoseconds stamp, MonotonicTime arrival);

  /// True where stamps are mapped by an offset.
  bool is_foreign() const { return foreign_; }

 private:
  void measure(std::chrono::nanoseconds offset);
  void begin_measuring();

  bool foreign_ = false;
  int measured_ = 0;
  int in_window_ = 0;
  std::chrono::nanoseconds largest_{};            ///< offset of those measured
  std::chrono::nanoseconds smallest_{};           ///< offset in this window
  std::chrono::nanoseconds previous_smallest_{};  ///< in the window before
};

}  // namespace sextant
