// SPDX-License-Identifier: Apache-2.0
// What a V4L2 node can deliver, and agreeing on one of it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hal/camera_device.h"
#include "hal/live/stream_options.h"
#include "hal/v4l2/v4l2_device.h"

namespace sextant {

/// Every format, size and fastest rate; of a size range its ends and the usual sizes within.
std::vector<CameraMode> list_modes(const V4l2Device& device);
/// "YUYV 640x480 at 30 Hz, 1280x720 at 10 Hz; MJPG ...", at most some 900 characters.
std::string modes_text(const std::vector<CameraMode>& modes);

/// What was agreed on.
struct AgreedFormat {
  PixelFormat format = PixelFormat::kYuyv;
  int width = 0;
  int height = 0;
  std::size_t stride = 0;  ///< bytes; 0 for compressed formats
  double rate_hz = 0;      ///< 0: the driver does not say
};

/// Sets format, size and rate. Throws DeviceError(where) with the list of what the device offers where it
/// takes another than the asked one, and DeviceUnready where the node is busy or gone.
AgreedFormat agree_on_format(const V4l2Device& device, const StreamOptions& options,
                             const std::string& where);

}  // namespace sextant
