// SPDX-License-Identifier: Apache-2.0
// Puts a live source together: two streams, their calibration, the pairing.
#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "hal/libcamera/libcamera_source.h"
#include "hal/pairing/paired_source.h"
#include "hal/playback/single_frame.h"
#include "hal/v4l2/v4l2_source.h"
#include "runtime/base/error.h"
#include "runtime/daemon/live_config.h"

namespace sextant {
namespace {

StreamOptions stream_options(const LiveConfig::Stream& stream, const LiveConfig& config, bool depth) {
  StreamOptions options;
  options.device = stream.device;
  options.depth = depth;
  options.format = stream.format;
  options.width = stream.width;
  options.height = stream.height;
  options.rate_hz = stream.rate_hz;
  options.controls = stream.controls;
  options.buffers = config.buffers;
  options.watchdog = std::chrono::milliseconds(std::llround(config.watchdog_ms));
  // Pairing needs every image; it hands out the newest pair.
  options.newest_only = false;
  options.wait_for_device = true;
  return options;
}

CameraFile camera_of(const LiveConfig::Stream& stream, const std::filesystem::path& folder, const char* section) {
  const std::filesystem::path file = (folder / stream.camera).lexically_normal();
  CameraFile camera = read_camera_file(file);
  if (camera.camera.width != stream.width || camera.camera.height != stream.height)
    throw InputError(file.string(),
                     fmt::format("is the calibration of {} x {} pixels, but {} is asked for {} x {}",
                                 camera.camera.width, camera.camera.height, section, stream.width, stream.height),
                     "give the calibration of this size");
  return camera;
}

}  // namespace

std::unique_ptr<FrameSource> open_live_source(const LiveConfig& config, const std::string& source_kind,
                                              const std::filesystem::path& folder, const std::string& frame_id) {
  const CameraFile colour = camera_of(config.colour, folder, "colour");
  const CameraFile depth = config.depth_registered ? colour : camera_of(config.depth, folder, "depth");
  PairedSourceOptions options;
  options.calibration.colour = colour.camera;
  options.calibration.depth = depth.camera;
  options.calibration.depth_is_registered = config.depth_registered;
  options.calibration.colour_from_depth = parse_rigid_transform(config.colour_from_depth, "the configuration");
  options.depth_scale.encoding = config.depth_encoding == "linear" ? DepthScale::Encoding::kLinear
                                                                   : DepthScale::Encoding::kKinectDisparity;
  options.depth_scale.metres_per_unit = depth.depth_scale_mm / 1000;
  options.depth_scale.nearest_m = config.depth_nearest_m;
  options.depth_scale.farthest_m = config.depth_farthest_m;
  options.synchroniser.tolerance =
      std::chrono::nanoseconds(std::llround(config.pair_tolerance_ms * 1e6));
  options.synchroniser.shared_sequence = config.shared_sequence;
  options.frame_id = frame_id;
  const StreamOptions colour_options = stream_options(config.colour, config, false);
  auto colour_stream =
      source_kind == "libcamera" ? open_libcamera_source(colour_options) : open_v4l2_source(colour_options);
  auto depth_stream = open_v4l2_source(stream_options(config.depth, config, true));
  return pair_streams(std::move(colour_stream), std::move(depth_stream), std::move(options));
}

}  // namespace sextant
