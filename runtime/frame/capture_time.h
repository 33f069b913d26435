// SPDX-License-Identifier: Apache-2.0
// When a frame was captured, on both clocks, and the one place where one clock becomes the other. Ages are
// measured on the monotonic clock (nobody sets it), messages carry the wall clock.
#pragma once

#include <chrono>

namespace sextant {

/// Nanoseconds since the Unix epoch (CLOCK_REALTIME).
using CaptureTime = std::chrono::time_point<std::chrono::system_clock, std::chrono::nanoseconds>;
/// Nanoseconds of CLOCK_MONOTONIC.
using MonotonicTime = std::chrono::time_point<std::chrono::steady_clock, std::chrono::nanoseconds>;

/// One instant on both clocks.
struct CaptureStamp {
  MonotonicTime monotonic{};
  CaptureTime realtime{};
};

/// Both clocks, read as close together as the kernel lets us (the best of three tries, below 1 us on an idle
/// machine).
CaptureStamp read_clocks();

/// The same instant with the other clock filled in, by the offset between the clocks in `clocks`. A wall
/// clock that was set between the capture and `clocks` is seen as it is now.
CaptureStamp stamp_of(MonotonicTime captured, const CaptureStamp& clocks);
CaptureStamp stamp_of(CaptureTime captured, const CaptureStamp& clocks);

}  // namespace sextant
