// SPDX-License-Identifier: Apache-2.0
// Plays a recording as if it were a camera: the source behind the demo, tests and soaks.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <string>

#include "hal/frame_source.h"
#include "hal/playback/frame_reel.h"

namespace sextant {

/// How time passes between the frames.
enum class PlaybackPace : std::uint8_t {
  kRate,        ///< rate_hz; 0: as fast as they are asked for
  kTimestamps,  ///< as they were captured, `speed` times as fast
};

/// The clock of playback; tests inject one that does not wait.
class PlaybackClock {
 public:
  using Time = std::chrono::steady_clock::time_point;
  virtual ~PlaybackClock() = default;
  virtual Time now() { return std::chrono::steady_clock::now(); }
  /// Returns when `until` has come or `closed` is true.
  virtual void wait(std::unique_lock<std::mutex>& lock, std::condition_variable& changed, Time until,
                    const std::function<bool()>& closed) {
    changed.wait_until(lock, until, closed);
  }
};

/// What to play and how.
struct PlaybackOptions : ReelOptions {
  PlaybackPace pace = PlaybackPace::kRate;
  double rate_hz = 0;  ///< frames per second, 0..10000; 0: as fast as they are asked for
  double speed = 1;    ///< of kTimestamps, 0.01..100
  bool loop = false;   ///< begin again after the last one
  /// captured_at is the time at which a frame is handed over and sequence counts from 0, as of a live camera;
  /// false: as recorded (a recording without times or numbers counts and stamps as above).
  bool restamp = true;
  std::string frame_id;  ///< given to every frame; empty: as recorded
  std::shared_ptr<PlaybackClock> clock = std::make_shared<PlaybackClock>();
};

/// Opens the recording. Frames are never skipped: a consumer that is late gets the next one at once and the
/// pace starts again from there. An image that cannot be read makes next() throw InputError and counts as
/// damaged; the call after it goes on with the following image. Throws InputError for a bad data set,
/// UsageError for options out of range and for kTimestamps where the recording has no times.
std::unique_ptr<FrameSource> open_playback(const PlaybackOptions& options);

}  // namespace sextant
