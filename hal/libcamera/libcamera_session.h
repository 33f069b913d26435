// SPDX-License-Identifier: Apache-2.0
// One streaming libcamera camera: requests circulate, images lie in the camera's own buffers.
#pragma once

#include <memory>

#include "hal/live/stream_options.h"
#include "hal/live/stream_session.h"

namespace sextant {

/// Throws DeviceUnready where the camera is away or in use, DeviceError where it does not offer what is
/// asked.
std::unique_ptr<StreamSession> open_libcamera_session(const StreamOptions& options);

}  // namespace sextant
