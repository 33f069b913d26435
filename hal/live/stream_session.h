// SPDX-License-Identifier: Apache-2.0
// One opened, streaming device. Drivers' interfaces (V4L2, libcamera) implement it; LiveSource keeps it alive
// and turns what arrives into images with times, numbers and statistics.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "hal/image_source.h"
#include "runtime/base/error.h"

namespace sextant {

/// The device cannot stream at the moment, but may later: it is away, busy, or failed to start.
struct DeviceUnready : DeviceError {
  using DeviceError::DeviceError;
};

/// What take() found.
struct Arrival {
  enum class Kind : std::uint8_t {
    kNothing,  ///< no more for now
    kImage,
    kDamaged,  ///< a frame that must not be used; device_sequence counts
    kGone,     ///< the session is over: the device went or its queue failed
  };
  Kind kind = Kind::kNothing;
  RawImage image;                          ///< of kImage; captured and sequence are not filled in yet
  std::uint32_t device_sequence = 0;       ///< of kImage and kDamaged
  std::chrono::nanoseconds device_time{};  ///< of kImage, on the device's clock, CLOCK_MONOTONIC as a rule
  std::string reason;                      ///< of kDamaged and kGone
};

/// Used by one thread, except that images may be released anywhere.
class StreamSession {
 public:
  virtual ~StreamSession() = default;
  /// Readable, or in error, whenever take() would not say kNothing.
  virtual int wait_fd() const = 0;
  /// The oldest arrival. Never blocks.
  virtual Arrival take() = 0;
  /// True while every buffer is in the consumer's hands: silence is not the device's fault then.
  virtual bool is_starved() const = 0;
  /// "YUYV 640x480, 30 Hz, 4 buffers"
  virtual std::string description() const = 0;
};

/// Opens a session. Throws DeviceUnready where another try may help, another DoorError where the device can
/// not do what is asked.
using OpenSession = std::function<std::unique_ptr<StreamSession>()>;

}  // namespace sextant
