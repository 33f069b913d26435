// SPDX-License-Identifier: Apache-2.0
// Which V4L2 cameras there are. /dev/videoN changes with the order of plugging; these identities do not:
//   by-id name         "usb-046d_HD_Webcam_A1B2-video-index0" (udev; maker, product, serial)
//   "serial:A1B2"      USB serial number
//   "bus:usb-0000:00:14.0-1"  where it is plugged in, as the driver says
//   a path             "/dev/video0", "/dev/v4l/by-path/..."
// "#1" after serial: and bus: takes the second capture node of that device ("#0" may be left out).
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "hal/camera_device.h"
#include "hal/v4l2/v4l2_device.h"

namespace sextant {

/// Where the kernel and udev show devices; another place in tests.
struct DevicePlaces {
  std::filesystem::path dev = "/dev";
  std::filesystem::path sys = "/sys";
};

/// Every node that captures video by streaming, in the order of node numbers; those that cannot be opened
/// have a problem. Modes and controls are asked for where `details` is set.
std::vector<CameraDevice> list_v4l2_devices(bool details, const DevicePlaces& places = {});

/// Opens the device of an id or alias. Throws DeviceUnready where none (now) has it, naming those there are;
/// DeviceError where two have it, and where it is no camera.
std::shared_ptr<V4l2Device> open_v4l2_device(const std::string& id, const DevicePlaces& places = {});

}  // namespace sextant
