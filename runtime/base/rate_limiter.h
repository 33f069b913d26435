// SPDX-License-Identifier: Apache-2.0
// Lets a flood of equal events through at a limited rate: for log lines that the outside can provoke.
#pragma once

#include <chrono>
#include <cstdint>
#include <utility>

namespace sextant {

/// Passes at most `burst` events per `period`, and counts what it holds back. Not thread-safe.
class RateLimiter {
 public:
  using Clock = std::chrono::steady_clock;

  RateLimiter(int burst, Clock::duration period) : burst_(burst), period_(period) {}

  /// True: let this one pass; `held_back` then says how many were not since the last one that passed.
  bool pass(Clock::time_point now, std::uint64_t& held_back) {
    if (passed_ == 0 || now - window_start_ >= period_) {
      window_start_ = now;
      passed_ = 0;
    }
    if (passed_ >= burst_) {
      ++held_back_;
      return false;
    }
    ++passed_;
    held_back = std::exchange(held_back_, 0);
    return true;
  }

 private:
  int burst_;
  Clock::duration period_;
  Clock::time_point window_start_{};
  int passed_ = 0;
  std::uint64_t held_back_ = 0;
};

}  // namespace sextant
