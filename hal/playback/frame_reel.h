// SPDX-License-Identifier: Apache-2.0
// A recording as playback sees it: frames by number, each with its capture time where it is known.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "runtime/frame/rgbd_frame.h"

namespace sextant {

class FrameReel {
 public:
  virtual ~FrameReel() = default;
  virtual std::size_t size() const = 0;
  /// When frame i was captured; nothing where the recording does not say.
  virtual std::optional<CaptureStamp> captured(std::size_t i) const = 0;
  /// Reads frame i, with the stamp, sequence number, camera name and table of the recording where it has
  /// them. Throws InputError for files that are missing or damaged.
  virtual RgbdFrame load(std::size_t i) const = 0;
  /// What was noticed on opening that does not stop playback ("the last line is cut off"), for people.
  virtual std::vector<std::string> remarks() const { return {}; }
};

/// Which frames of which data set.
struct ReelOptions {
  std::filesystem::path dataset;  ///< BOP folder, TUM RGB-D folder, or what `sextant record` wrote
  std::string split = "test";     ///< of BOP data sets and recordings
  int scene = -1;                 ///< BOP and recordings: this scene only; -1: all, in numeric order
  int image = -1;                 ///< this image number only; -1: all, in numeric order
};

/// Opens the lists of a data set (not the images). The kind is told by the files: rgb.txt and depth.txt are
/// TUM RGB-D; a scene with frames.jsonl is a recording of ours; all else is BOP. Throws InputError /
/// UsageError.
std::unique_ptr<FrameReel> open_reel(const ReelOptions& options);

/// The kinds. Each throws InputError.
std::unique_ptr<FrameReel> open_bop_reel(const ReelOptions& options);
std::unique_ptr<FrameReel> open_tum_reel(const ReelOptions& options);
std::unique_ptr<FrameReel> open_recording_reel(const ReelOptions& options);

/// Is it one of these?
bool is_tum_folder(const std::filesystem::path& folder);
bool is_recording(const std::filesystem::path& folder, const std::string& split);

}  // namespace sextant
