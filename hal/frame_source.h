// SPDX-License-Identifier: Apache-2.0
// Where RGB-D frames come from: the one interface that every source of hal/ implements. A single colour or
// depth camera is an ImageSource (image_source.h); two of them make a FrameSource.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>

#include "hal/source_status.h"
#include "runtime/frame/rgbd_frame.h"

namespace sextant {

/// A source of RGB-D frames. One thread calls next(); all else may come from any thread. A frame is whole,
/// newer than the one before it, and carries captured_at, captured_monotonic and a rising sequence.
///
/// Errors: a frame that can never be read (damaged file) makes next() throw InputError, the call after it
/// goes on. A live device that goes away is no error: the state becomes kWaiting and frames return with the
/// device. DeviceError means that waiting is in vain.
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  /// The next frame, or nothing when none came within the timeout or the source has ended: see state(). Live
  /// sources hand out the newest frame and count the ones before it.
  virtual std::optional<RgbdFrame> next(std::chrono::milliseconds timeout) = 0;
  virtual SourceState state() const = 0;
  /// One line about the state, for people: what is waited for, and why. May be empty while kRunning.
  virtual std::string condition() const { return {}; }
  virtual SourceStatistics statistics() const = 0;
  /// Ends it; a waiting next() returns within 100 ms.
  virtual void close() = 0;
};

}  // namespace sextant
