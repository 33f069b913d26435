// SPDX-License-Identifier: Apache-2.0
#include "hal/libcamera/libcamera_source.h"

#include <fmt/format.h>

#include "hal/libcamera/camera_system.h"
#include "hal/libcamera/libcamera_controls.h"
#include "hal/libcamera/libcamera_session.h"
#include "hal/live/live_source.h"

namespace sextant {
namespace {

namespace lc = libcamera;

void add_details(CameraDevice& device, lc::Camera& camera) {
  device.controls = list_libcamera_controls(camera);
  const auto configuration = libcamera_api::video_configuration(camera);
  if (!configuration || configuration->empty()) {
    device.problem = "it has no video stream";
    return;
  }
  const lc::StreamFormats& formats = configuration->at(0).formats();
  for (const lc::PixelFormat& theirs : formats.pixelformats()) {
    CameraMode mode;
    mode.fourcc = theirs.toString();
    for (const auto& entry : libcamera_api::formats()) {
      if (entry.second == theirs) mode.format = entry.first;
    }
    if (mode.format) mode.fourcc = info_of(*mode.format).name;
    std::vector<lc::Size> sizes = formats.sizes(theirs);
    if (sizes.empty()) sizes = {formats.range(theirs).min, formats.range(theirs).max};
    for (const lc::Size& size : sizes) {
      mode.width = static_cast<int>(size.width);
      mode.height = static_cast<int>(size.height);
      device.modes.push_back(mode);
    }
  }
}

}  // namespace

bool has_libcamera() { return true; }

std::vector<CameraDevice> list_libcamera_devices(bool details) {
  const CameraSystem system;
  std::vector<CameraDevice> devices;
  for (const auto& camera : system.cameras()) {
    CameraDevice device;
    device.kind = "libcamera";
    device.id = camera->id();
    device.name = libcamera_api::model_of(*camera);
    if (device.name != device.id) device.aliases.push_back(device.name);
    device.driver = "libcamera " + lc::CameraManager::version();
    if (details) add_details(device, *camera);
    devices.push_back(std::move(device));
  }
  return devices;
}

std::unique_ptr<ImageSource> open_libcamera_source(const StreamOptions& options) {
  check_stream_options(options);
  if (options.depth) throw UsageError("libcamera gives colour only", "take depth from a v4l2 device");
  return make_live_source("libcamera " + options.device, options,
                          [=] { return open_libcamera_session(options); });
}

}  // namespace sextant
