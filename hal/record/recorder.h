// SPDX-License-Identifier: Apache-2.0
// Takes frames from a live source without ever holding it up: writing happens on a thread of its own behind a
// bounded queue. A frame that is lost on the way is counted, by reason, and said.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "hal/record/recording_writer.h"

namespace sextant {

struct RecorderStatistics {
  std::uint64_t offered = 0;
  std::uint64_t recorded = 0;
  std::uint64_t lost_slow = 0;    ///< the queue was full: the disk does not keep up
  std::uint64_t lost_failed = 0;  ///< writing failed
  int waiting = 0;                ///< in the queue now
  std::string last_failure;       ///< why the last write failed
};

struct RecorderOptions {
  int queue_frames = 30;  ///< that may wait for the disk, 1..1000 (2.2 MB each at 640 x 480)
  /// So many failures in a row end the recording: the disk will not recover by itself.
  int failures_to_give_up = 30;
  /// Called with one line when frames begin to be lost and when that is over; from either thread.
  std::function<void(const std::string&)> say;
};

class Recorder {
 public:
  Recorder(std::unique_ptr<FrameSink> sink, RecorderOptions options);
  /// Without finish(): what waits is lost, nothing is ended.
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// Queues a frame and returns at once. False: lost, and counted.
  bool offer(RgbdFrame frame);
  /// So many writes in a row have failed that going on is pointless.
  bool given_up() const;
  RecorderStatistics statistics() const;
  /// Waits until everything queued is written, then ends the recording. lost_source: what the source says it
  /// dropped. Throws DoorError where the end could not be written.
  RecorderStatistics finish(std::uint64_t lost_source);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sextant
