// SPDX-License-Identifier: Apache-2.0
// The one loop behind every next(timeout) of a source that waits by itself: try, wait, try again, until
// something comes, the time is up, or the source is closed.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <optional>
#include <type_traits>

namespace sextant {

using WaitClock = std::chrono::steady_clock;

/// What is left until the deadline in whole milliseconds, rounded up, never negative.
inline std::chrono::milliseconds left_until(WaitClock::time_point deadline) {
  return std::max(std::chrono::milliseconds(0),
                  std::chrono::ceil<std::chrono::milliseconds>(deadline - WaitClock::now()));
}

/// Calls attempt(deadline) until it returns something; an empty optional after the deadline or once `closed`.
/// An attempt that finds nothing waits itself: for news, for close(), at most until the deadline. There is
/// one attempt at least, and one more after a wait that ended at the deadline, so that nothing that came in
/// time is left for the next call.
template <typename Attempt>
auto wait_for_result(std::chrono::milliseconds timeout, const std::atomic<bool>& closed, Attempt attempt)
    -> std::invoke_result_t<Attempt, WaitClock::time_point> {
  const WaitClock::time_point deadline = WaitClock::now() + timeout;
  bool last = false;
  while (!closed && !last) {
    last = WaitClock::now() >= deadline;
    if (auto result = attempt(deadline)) return result;
  }
  return std::nullopt;
}

}  // namespace sextant
