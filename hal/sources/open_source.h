// SPDX-License-Identifier: Apache-2.0
// One door to every kind of source: what sextantd, `sextant record` and `sextant camera` open.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "hal/dds/dds_rgbd_source.h"
#include "hal/frame_source.h"
#include "hal/live/stream_options.h"
#include "hal/pairing/rig_file.h"
#include "hal/playback/playback_source.h"

namespace sextant {

/// The kinds that this build has: "playback", "v4l2", "dds", ...
std::vector<std::string> source_kinds();

struct SourceOptions {
  std::string kind = "playback";
  PlaybackOptions playback;     ///< of kind playback
  StreamOptions colour, depth;  ///< of kind v4l2 and libcamera; sizes come from the rig file
  std::string depth_kind;       ///< of the depth stream where it is not that of the colour stream
  std::filesystem::path rig;    ///< calibration of the two cameras; needed by devices, may replace CameraInfo
  DdsRgbdOptions dds;           ///< of kind dds; domain, topics
  bool rectify = true;          ///< of devices and dds: undo lens distortion and fx != fy
  int width = 0;                ///< of devices and dds: of the frames, 64..4096; 0: the colour image's
  std::chrono::milliseconds max_age{
      100};              ///< of devices and dds: older frames are dropped as stale; 0: none is
  std::string frame_id;  ///< given to every frame; empty: as the source says
};

/// Throws UsageError for options that cannot work, InputError for files, DeviceError for devices.
std::unique_ptr<FrameSource> open_source(const SourceOptions& options);

}  // namespace sextant
