// SPDX-License-Identifier: Apache-2.0
// The daemon's flow: source thread -> newest frame -> detection thread -> newest result -> publication
// thread, so that reading and publishing one frame overlap with detecting another. Late results are dropped
// and counted, never published as fresh; a bad frame is counted and passed over; a dead device ends it.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "hal/frame_source.h"
#include "runtime/refine/frame_result.h"

namespace sextant {

/// Frame in, poses out; may throw.
using DetectFunction = std::function<FrameResult(const RgbdFrame&)>;
/// Result, and the frame that it is about, out of the process; may throw.
using PublishFunction = std::function<void(const FrameResult&, const RgbdFrame&)>;

/// How frames flow.
struct PipelineOptions {
  int queue_frames = 1;         ///< may wait for detection, 1..100
  bool skip_none = false;       ///< take a frame only when detection is idle (for unpaced playback)
  double max_age_ms = 1000;     ///< from capture to publication
  double max_frame_age_ms = 0;  ///< from capture to the begin of detection; 0: any
  bool once = false;            ///< end after the first frame, whatever became of it
};

/// What became of a frame.
enum class FrameFate : std::uint8_t {
  kPublished,
  kTooOld,  ///< detected, but older than max_age_ms
  kStale,   ///< older than max_frame_age_ms before detection began
  kFailed,  ///< the source, the detector or the publisher refused it
};

/// Where a published frame's time went, milliseconds. They add up to age_ms but for the time between two
/// stages.
struct FrameTimes {
  double capture_ms = 0;   ///< from capture to us
  double waiting_ms = 0;   ///< for detection
  double features_ms = 0;  ///< with rectification and the table
  double tables_ms = 0;
  double search_ms = 0;
  double refine_ms = 0;
  double handover_ms = 0;  ///< waiting for publication
  double publish_ms = 0;
};

/// One frame's story.
struct FrameReport {
  FrameFate fate = FrameFate::kPublished;
  std::int64_t sequence = 0;
  int poses = 0;
  double age_ms = 0;     ///< from capture to the decision, of kPublished to the end of publication
  std::string reason{};  ///< for all but kPublished
  FrameTimes times{};    ///< of kPublished
};

/// Counts since the start.
struct PipelineStatistics {
  std::uint64_t dropped = 0;      ///< waiting frames that newer ones pushed out
  std::uint64_t unpublished = 0;  ///< waiting results that newer ones pushed out
  std::uint64_t asked = 0;      ///< times that the source was asked for a frame and answered: it is not stuck
  std::uint64_t published = 0;  ///< results
  std::uint64_t too_old = 0;    ///< results
  std::uint64_t stale = 0;      ///< frames
  std::uint64_t failed = 0;     ///< frames
};

/// Runs from construction until the source ends, stop(), or a DeviceError.
class Pipeline {
 public:
  /// `report` is called by one thread at a time. The source and what the functions use must outlive the
  /// pipeline.
  Pipeline(FrameSource& source, DetectFunction detect, PublishFunction publish,
           const PipelineOptions& options, std::function<void(const FrameReport&)> report);
  /// Stops and waits for a detection that is under way.
  ~Pipeline();
  Pipeline(const Pipeline&) = delete;
  Pipeline& operator=(const Pipeline&) = delete;

  /// Waits until everything has ended; false after the timeout.
  bool wait(std::chrono::milliseconds timeout) const;
  /// Ends soon: nothing is published after this returns; a detection that is under way still runs on.
  void stop();
  PipelineStatistics statistics() const;
  /// Throws what ended the pipeline, if it was an error (with `once` also a frame's error).
  void rethrow_error() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sextant
