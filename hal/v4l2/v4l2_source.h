// SPDX-License-Identifier: Apache-2.0
// One V4L2 stream as an ImageSource: zero-copy images, survives everything a driver does (live_source.h).
#pragma once

#include <memory>

#include "hal/image_source.h"
#include "hal/live/stream_options.h"
#include "hal/v4l2/v4l2_devices.h"

namespace sextant {

/// Throws UsageError for options out of range, DeviceUnready / DeviceError as make_live_source(): the device
/// is absent, may not be opened, does not offer the format, or does not take a control.
std::unique_ptr<ImageSource> open_v4l2_source(const StreamOptions& options, const DevicePlaces& places = {});

}  // namespace sextant
