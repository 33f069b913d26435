// SPDX-License-Identifier: Apache-2.0
// What `sextant record` writes beside the images of a scene: frames.jsonl, one JSON object a line, appended
// as frames come, so that an interrupted recording plays up to its last whole frame. First a header, then one
// line a frame with camera, table and times, at last how it ended. scene_camera.json and scene_table.json are
// made from it at the end, so that the folder is a BOP data set too.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "runtime/frame/rgbd_frame.h"

namespace sextant {

inline constexpr int kRecordingVersion = 1;
inline constexpr char kRecordingList[] = "frames.jsonl";

/// One line of a frame. `frame` has no images.
struct RecordedFrame {
  int image_id = 0;
  double depth_scale_mm = 0.1;  ///< of the depth file's values
  RgbdFrame frame;
};

/// How a recording ended.
struct RecordingEnd {
  std::uint64_t recorded = 0;
  std::uint64_t lost_slow = 0;    ///< the disk did not keep up
  std::uint64_t lost_failed = 0;  ///< writing failed
  std::uint64_t lost_source = 0;  ///< dropped by the source, for any reason
};

/// Lines with their line end.
std::string recording_header();
std::string line_of(const RecordedFrame& recorded);
std::string line_of(const RecordingEnd& end);

/// What a frames.jsonl says.
struct RecordingList {
  std::vector<RecordedFrame> frames;
  std::vector<std::string> remarks;  ///< cut off, interrupted, frames lost
};

/// Throws InputError(file:line) for anything but a cut-off last line.
RecordingList read_recording_list(const std::filesystem::path& file);

}  // namespace sextant
