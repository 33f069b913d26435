// SPDX-License-Identifier: Apache-2.0
// Colour through libcamera: for cameras that V4L2 alone cannot run (image signal processors of single-board
// computers). Built where libcamera-dev is installed; without it both functions say so.
#pragma once

#include <memory>
#include <vector>

#include "hal/camera_device.h"
#include "hal/image_source.h"
#include "hal/live/stream_options.h"

namespace sextant {

/// False where this build has no libcamera.
bool has_libcamera();

/// Every camera of libcamera; empty without it. Throws DeviceUnready where its manager does not start.
std::vector<CameraDevice> list_libcamera_devices(bool details);

/// As open_v4l2_source(); `device` is libcamera's id of the camera or its model name. Throws DeviceError
/// where this build has no libcamera, UsageError for depth.
std::unique_ptr<ImageSource> open_libcamera_source(const StreamOptions& options);

}  // namespace sextant
