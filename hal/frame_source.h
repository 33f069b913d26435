// SPDX-License-Identifier: Apache-2.0
// Where frames come from: the one interface that every source of hal/ implements.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "runtime/frame/rgbd_frame.h"

namespace sextant {

/// What a source did so far.
struct SourceStatistics {
  std::uint64_t delivered = 0;
  std::uint64_t dropped = 0;  ///< frames that were lost or skipped, for any reason
};

/// Why next() gave no frame.
enum class SourceState : std::uint8_t {
  kRunning,  ///< nothing yet within the timeout
  kEnded,    ///< no more frames will come
};

/// A source of RGB-D frames. One thread calls next(); close() may come from any thread and makes a waiting
/// next() return within 100 ms. Errors of the device or the data are thrown as DoorError.
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  /// The next frame, or nothing when none came within the timeout or the source has ended: see state().
  virtual std::optional<RgbdFrame> next(std::chrono::milliseconds timeout) = 0;
  virtual SourceState state() const = 0;
  virtual SourceStatistics statistics() const = 0;
  virtual void close() = 0;
};

}  // namespace sextant
