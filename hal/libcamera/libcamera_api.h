// SPDX-License-Identifier: Apache-2.0
// All of libcamera that we use, and where its versions differ (0.0.3 of Debian 12 to today's). Headers that
// other rooms see do not include this.
#pragma once

#include <libcamera/camera.h>
#include <libcamera/camera_manager.h>
#include <libcamera/control_ids.h>
#include <libcamera/formats.h>
#include <libcamera/framebuffer.h>
#include <libcamera/framebuffer_allocator.h>
#include <libcamera/property_ids.h>
#include <libcamera/request.h>
#include <libcamera/stream.h>
#include <libcamera/version.h>

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "hal/pixel_format.h"

namespace sextant::libcamera_api {

namespace lc = libcamera;

#define SEXTANT_LIBCAMERA \
  (LIBCAMERA_VERSION_MAJOR * 10000 + LIBCAMERA_VERSION_MINOR * 100 + LIBCAMERA_VERSION_PATCH)

/// libcamera names formats as DRM does, by the value of a little-endian pixel: its RGB888 lies in memory as
/// B, G, R.
inline const std::vector<std::pair<PixelFormat, lc::PixelFormat>>& formats() {
  static const std::vector<std::pair<PixelFormat, lc::PixelFormat>> kList{
      {PixelFormat::kYuyv, lc::formats::YUYV},    {PixelFormat::kUyvy, lc::formats::UYVY},
      {PixelFormat::kNv12, lc::formats::NV12},    {PixelFormat::kRgb24, lc::formats::BGR888},
      {PixelFormat::kBgr24, lc::formats::RGB888}, {PixelFormat::kMjpeg, lc::formats::MJPEG},
      {PixelFormat::kGrey, lc::formats::R8},
  };
  return kList;
}

inline std::unique_ptr<lc::CameraConfiguration> video_configuration(lc::Camera& camera) {
  // A std::vector until 0.1, a Span since: an array of one becomes either.
#if SEXTANT_LIBCAMERA < 100
  return camera.generateConfiguration(lc::StreamRoles{lc::StreamRole::Viewfinder});
#else
  const std::array<lc::StreamRole, 1> roles{lc::StreamRole::Viewfinder};
  return camera.generateConfiguration(roles);
#endif
}

/// The maker's name, or the id.
inline std::string model_of(const lc::Camera& camera) {
  return camera.properties().get(lc::properties::Model).value_or(camera.id());
}

/// Sets the time between frames, where the camera lets it be set.
inline void set_rate(lc::ControlList& controls, const lc::Camera& camera, double rate_hz) {
  if (camera.controls().find(lc::controls::FrameDurationLimits.id()) == camera.controls().end()) return;
  const auto microseconds = static_cast<std::int64_t>(1e6 / rate_hz);
  controls.set(lc::controls::FrameDurationLimits, {microseconds, microseconds});
}

}  // namespace sextant::libcamera_api
