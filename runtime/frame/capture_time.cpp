// SPDX-License-Identifier: Apache-2.0
#include "runtime/frame/capture_time.h"

namespace sextant {

CaptureStamp read_clocks() {
  CaptureStamp best;
  auto narrowest = std::chrono::nanoseconds::max();
  for (int round = 0; round < 3; ++round) {
    const MonotonicTime before = std::chrono::steady_clock::now();
    const CaptureTime realtime = std::chrono::system_clock::now();
    const std::chrono::nanoseconds width = std::chrono::steady_clock::now() - before;
    if (width < narrowest) {
      narrowest = width;
      best = {before + width / 2, realtime};
    }
  }
  return best;
}

CaptureStamp stamp_of(MonotonicTime captured, const CaptureStamp& clocks) {
  return {captured, clocks.realtime + (captured - clocks.monotonic)};
}

CaptureStamp stamp_of(CaptureTime captured, const CaptureStamp& clocks) {
  return {clocks.monotonic + (captured - clocks.realtime), captured};
}

}  // namespace sextant
