// SPDX-License-Identifier: Apache-2.0
// A device's 32-bit frame numbers -> one rising 64-bit sequence over wraps, restarts and reconnections.
#pragma once

#include <cstdint>

namespace sextant {

class SequenceCounter {
 public:
  struct Step {
    std::int64_t sequence = 0;
    std::uint32_t lost = 0;  ///< numbers that were skipped before this one
  };

  /// The device's next number. One that is the same or behind means that the device began anew: nothing is
  /// counted as lost then.
  Step next(std::uint32_t number) {
    const std::uint32_t ahead = number - last_;
    Step step;
    if (known_ && ahead != 0 && ahead < kHalf) {
      sequence_ += ahead;
      step.lost = ahead - 1;
    } else {
      ++sequence_;
    }
    known_ = true;
    last_ = number;
    step.sequence = sequence_;
    return step;
  }

  /// The stream was opened anew: its numbers say nothing about the ones before.
  void restart() { known_ = false; }

 private:
  static constexpr std::uint32_t kHalf = 1U << 31;
  bool known_ = false;
  std::uint32_t last_ = 0;
  std::int64_t sequence_ = -1;
};

}  // namespace sextant
