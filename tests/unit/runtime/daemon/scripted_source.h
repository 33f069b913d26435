// SPDX-License-Identifier: Apache-2.0
// A source that plays what a test tells it to.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>

#include "hal/frame_source.h"

namespace sextant {

/// Frames with stamps of now, numbered from 0; each step may throw instead.
class ScriptedSource : public FrameSource {
 public:
  /// Called for every frame before it is handed over; may change it, wait, or throw.
  using Step = std::function<void(RgbdFrame&)>;

  explicit ScriptedSource(int frames, Step step = {}) : frames_(frames), step_(std::move(step)) {}

  std::optional<RgbdFrame> next(std::chrono::milliseconds timeout) override {
    std::unique_lock lock(mutex_);
    if (closed_ || sequence_ >= frames_) {
      // A source without frames waits, as a camera does.
      changed_.wait_for(lock, timeout, [&] { return closed_; });
      return std::nullopt;
    }
    RgbdFrame frame;
    frame.colour = cv::Mat::zeros(4, 4, CV_8UC3);
    frame.axial_depth_m = cv::Mat::ones(4, 4, CV_32FC1);
    const CaptureStamp now = read_clocks();
    frame.captured_at = now.realtime;
    frame.captured_monotonic = now.monotonic;
    frame.sequence = sequence_++;
    frame.frame_id = "camera";
    ++statistics_.delivered;
    lock.unlock();
    if (step_) step_(frame);
    return frame;
  }
  SourceState state() const override {
    const std::lock_guard lock(mutex_);
    if (closed_ || (ends_ && sequence_ >= frames_)) return SourceState::kEnded;
    return waits_ && sequence_ >= frames_ ? SourceState::kWaiting : SourceState::kRunning;
  }
  SourceStatistics statistics() const override {
    const std::lock_guard lock(mutex_);
    return statistics_;
  }
  void close() override {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    changed_.notify_all();
  }
  std::string condition() const override { return "the scripted device is away"; }
  /// Never ends by itself.
  void run_forever() { ends_ = false; }
  /// After its frames it waits for its device, for ever.
  void lose_device() {
    ends_ = false;
    waits_ = true;
  }

 private:
  const std::int64_t frames_;
  const Step step_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::int64_t sequence_ = 0;
  SourceStatistics statistics_;
  bool closed_ = false;
  bool ends_ = true;
  bool waits_ = false;
};

/// Moves a frame's capture on both clocks.
inline void shift_capture(RgbdFrame& frame, std::chrono::nanoseconds by) {
  frame.captured_at += by;
  frame.captured_monotonic += by;
}

/// A detection that finds nothing: carries the frame's identity over.
inline FrameResult empty_result(const RgbdFrame& frame) {
  FrameResult result;
  result.captured_at = frame.captured_at;
  result.frame_id = frame.frame_id;
  result.sequence = frame.sequence;
  return result;
}

}  // namespace sextant
