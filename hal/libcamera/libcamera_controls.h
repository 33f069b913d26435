// SPDX-License-Identifier: Apache-2.0
// libcamera's controls by name: "AeEnable=false", "ExposureTime=8000", "AnalogueGain=2.5".
#pragma once

#include <string>
#include <vector>

#include "hal/camera_device.h"
#include "hal/libcamera/libcamera_api.h"

namespace sextant {

/// Those that are one number or switch; fractions are cut in the listed range.
std::vector<CameraControl> list_libcamera_controls(const libcamera::Camera& camera);

/// Adds "Name=value" requests to `controls`. Throws DeviceError(where) for unknown names and bad values.
void add_libcamera_controls(libcamera::ControlList& controls, const libcamera::Camera& camera,
                            const std::vector<std::string>& requests, const std::string& where);

}  // namespace sextant
