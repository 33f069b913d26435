// SPDX-License-Identifier: Apache-2.0
// Builds without libcamera-dev.
#include "hal/libcamera/libcamera_source.h"
#include "runtime/base/error.h"

namespace sextant {

bool has_libcamera() { return false; }

std::vector<CameraDevice> list_libcamera_devices(bool /*details*/) { return {}; }

std::unique_ptr<ImageSource> open_libcamera_source(const StreamOptions& options) {
  throw DeviceError(options.device, "this build has no libcamera",
                    "install libcamera-dev and build again, or use a v4l2 device");
}

}  // namespace sextant
