// SPDX-License-Identifier: Apache-2.0
// How long to wait before the next try to get a device back: soon after it went (most come back at once, with
// another node), then less often, never so rarely that a robot waits for its camera.
#pragma once

#include <algorithm>
#include <chrono>

namespace sextant {

class Backoff {
 public:
  static constexpr std::chrono::milliseconds kFirst{50};
  static constexpr std::chrono::milliseconds kLongest{400};

  /// The pause before the next try; each is twice the one before.
  std::chrono::milliseconds next() {
    const std::chrono::milliseconds pause = pause_;
    pause_ = std::min(2 * pause_, kLongest);
    return pause;
  }
  /// A frame came: all is well.
  void reset() { pause_ = kFirst; }

 private:
  std::chrono::milliseconds pause_ = kFirst;
};

}  // namespace sextant
