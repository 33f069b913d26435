// SPDX-License-Identifier: Apache-2.0
// The controls of a V4L2 node: exposure, gain, power line frequency and whatever else the driver has.
#pragma once

#include <string>
#include <vector>

#include "hal/camera_device.h"
#include "hal/v4l2/v4l2_device.h"

namespace sextant {

/// Whole numbers, switches, menus and buttons; no strings and no arrays.
std::vector<CameraControl> list_controls(const V4l2Device& device);

/// Sets "name=value" requests in their order. Throws DeviceError(where) for what the device does not have or
/// take.
void set_controls(const V4l2Device& device, const std::vector<std::string>& requests,
                  const std::string& where);

}  // namespace sextant
