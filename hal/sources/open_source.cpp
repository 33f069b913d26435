// SPDX-License-Identifier: Apache-2.0
#include "hal/sources/open_source.h"

#include <algorithm>
#include <string>

#include "hal/libcamera/libcamera_source.h"
#include "hal/v4l2/v4l2_source.h"
#include "runtime/base/error.h"

namespace sextant {
namespace {

/// A stream of one device.
std::unique_ptr<ImageSource> open_stream(const std::string& kind, const StreamOptions& options) {
  if (kind == "v4l2") return open_v4l2_source(options);
  if (kind == "libcamera") return open_libcamera_source(options);
  throw UsageError("a stream of kind \"" + kind + "\" is not in this build", "use v4l2");
}

StreamOptions stream_of(StreamOptions stream, const CameraModel& camera, bool depth,
                        std::chrono::milliseconds max_age, const char* which) {
  if (stream.device.empty()) {
    throw UsageError(std::string("the ") + which + " camera is not named", "see sextant camera list");
  }
  stream.width = camera.width;
  stream.height = camera.height;
  stream.depth = depth;
  stream.max_age = max_age;
  // Pairing decides which image is handed out: none may be passed over before it.
  stream.newest_only = false;
  return stream;
}

PairedSourceOptions pairing_of(const SourceOptions& options) {
  PairedSourceOptions pairing;
  if (options.width != 0 && (options.width < 64 || options.width > 4096)) {
    throw UsageError("frames cannot be " + std::to_string(options.width) + " pixels wide",
                     "use 64 to 4096, or 0 for the colour image's width");
  }
  pairing.composer.rectify = options.rectify;
  pairing.composer.width = options.width;
  pairing.max_age = options.max_age;
  pairing.frame_id = options.frame_id;
  return pairing;
}

std::unique_ptr<FrameSource> open_devices(const SourceOptions& options) {
  if (options.rig.empty()) {
    throw UsageError("a colour and a depth camera need a calibration", "give a rig file (docs/cameras.md)");
  }
  const RigFile rig = read_rig_file(options.rig);
  PairedSourceOptions pairing = pairing_of(options);
  pairing.calibration = rig.calibration;
  pairing.depth_scale = rig.depth_scale;
  pairing.synchroniser = rig.synchroniser;
  const CameraModel& depth_camera =
      rig.calibration.depth_is_registered ? rig.calibration.colour : rig.calibration.depth;
  auto colour = open_stream(
      options.kind, stream_of(options.colour, rig.calibration.colour, false, options.max_age, "colour"));
  // libcamera has no depth cameras.
  const std::string depth_kind = !options.depth_kind.empty()   ? options.depth_kind
                                 : options.kind == "libcamera" ? "v4l2"
                                                               : options.kind;
  auto depth =
      open_stream(depth_kind, stream_of(options.depth, depth_camera, true, options.max_age, "depth"));
  return pair_streams(std::move(colour), std::move(depth), std::move(pairing));
}

std::unique_ptr<FrameSource> open_dds(const SourceOptions& options) {
  DdsRgbdOptions dds = options.dds;
  dds.pairing = pairing_of(options);
  if (!options.rig.empty()) {
    const RigFile rig = read_rig_file(options.rig);
    dds.calibration = rig.calibration;
    dds.pairing.depth_scale = rig.depth_scale;
    dds.pairing.synchroniser = rig.synchroniser;
  }
  return open_dds_rgbd(dds);
}

}  // namespace

std::vector<std::string> source_kinds() { return {"playback", "v4l2", "libcamera", "dds"}; }

std::unique_ptr<FrameSource> open_source(const SourceOptions& options) {
  if (options.kind == "playback") {
    PlaybackOptions playback = options.playback;
    if (!options.frame_id.empty()) playback.frame_id = options.frame_id;
    return open_playback(playback);
  }
  if (options.kind == "dds") return open_dds(options);
  const std::vector<std::string> kinds = source_kinds();
  if (std::find(kinds.begin(), kinds.end(), options.kind) != kinds.end()) return open_devices(options);
  std::string known;
  for (const std::string& kind : kinds) known += (known.empty() ? "" : ", ") + kind;
  throw UsageError("no source is of kind \"" + options.kind + "\"", "this build has " + known);
}

}  // namespace sextant
