// SPDX-License-Identifier: Apache-2.0
// A recording on disk, frame by frame: a scene of a BOP data set with frames.jsonl beside its images
// (hal/playback/recording_format.h).
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

#include "hal/playback/recording_format.h"
#include "runtime/frame/rgbd_frame.h"

namespace sextant {

/// Where recorded frames go. One thread.
class FrameSink {
 public:
  virtual ~FrameSink() = default;
  /// Throws DoorError for a frame that could not be written; nothing of it remains, and the next one may
  /// work.
  virtual void write(const RgbdFrame& frame) = 0;
  /// Ends the recording. Throws DoorError where its lists could not be written.
  virtual void finish(const RecordingEnd& end) = 0;
};

struct RecordingOptions {
  std::filesystem::path folder;  ///< of the data set; made where it does not exist
  std::string split = "test";
  double depth_scale_mm = 0.1;  ///< of the 16-bit depth files: 0.1 reaches 6.5 m
  int png_compression = 1;      ///< 0..9 of zlib: 1 keeps up with a camera
};

/// A new scene in the folder, numbered after the last one there.
class RecordingWriter final : public FrameSink {
 public:
  /// Makes the folders and begins frames.jsonl. Throws InputError / UsageError where it cannot.
  explicit RecordingWriter(const RecordingOptions& options);
  ~RecordingWriter() override;

  /// Writes both images, then the line that makes them part of the recording.
  void write(const RgbdFrame& frame) override;
  /// Writes the end, scene_camera.json, and scene_table.json where tables are known.
  void finish(const RecordingEnd& end) override;

  const std::filesystem::path& scene_folder() const;
  std::uint64_t bytes_written() const;
  /// Depth pixels that the 16 bits could not hold and that were written as missing.
  std::uint64_t depth_out_of_range() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sextant
