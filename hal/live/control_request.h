// SPDX-License-Identifier: Apache-2.0
// "name=value" of the configuration against the controls that a device has.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hal/camera_device.h"

namespace sextant {

/// The control a request names, and its value as a number.
struct ControlRequest {
  const CameraControl* control = nullptr;  ///< in `known`
  std::int64_t value = 0;
};

/// Throws DeviceError(where): no "name=value", an unknown name (with the nearest or all known), a value that
/// is no number, menu text, or out of range, a control that cannot be set.
ControlRequest read_control_request(const std::string& text, const std::vector<CameraControl>& known,
                                    const std::string& where);

/// "Exposure Time, Absolute" -> "exposure_time_absolute", as v4l2-ctl names controls.
std::string control_name(const std::string& title);

}  // namespace sextant
