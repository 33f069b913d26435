// SPDX-License-Identifier: Apache-2.0
// Which cameras there are, by identities that survive a reboot and another order of plugging, and what they
// offer. `sextant camera list` prints it, `source.colour.device` and the like take the ids.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hal/pixel_format.h"

namespace sextant {

/// One way a device can stream.
struct CameraMode {
  std::string fourcc;                 ///< four letters
  std::optional<PixelFormat> format;  ///< empty: we cannot decode it
  int width = 0;                      ///< pixels
  int height = 0;                     ///< pixels
  double max_rate_hz = 0;             ///< 0: the device does not say
};

/// One knob of a device.
struct CameraControl {
  std::string name;   ///< as the configuration writes it, e.g. "exposure_time_absolute"
  std::string title;  ///< as the driver calls it
  std::int64_t lowest = 0;
  std::int64_t highest = 0;
  std::int64_t step = 1;
  std::int64_t standard = 0;          ///< the driver's default
  std::optional<std::int64_t> value;  ///< now
  std::vector<std::string> menu;      ///< of menu controls, by value - lowest; "" where invalid
  bool read_only = false;
};

/// One stream of a camera.
struct CameraDevice {
  std::string kind;                  ///< "v4l2" or "libcamera": the source that opens it
  std::string id;                    ///< the stablest identity; opening takes it
  std::vector<std::string> aliases;  ///< further names that open it: by-id, by-path, serial, node
  std::string node;                  ///< "/dev/video0"; empty for libcamera
  std::string name;                  ///< the maker's
  std::string driver;
  std::string bus;
  std::string serial;  ///< empty: none
  std::vector<CameraMode> modes;
  std::vector<CameraControl> controls;
  std::string problem;  ///< why it cannot be used, and what to do; empty: it can
};

}  // namespace sextant
