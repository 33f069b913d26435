// SPDX-License-Identifier: Apache-2.0
// Frames on their way from the source's thread to detection: a bounded queue that drops the oldest frame,
// never the newest.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <utility>

#include "runtime/frame/rgbd_frame.h"

namespace sextant {

/// One producer, one consumer.
class FrameQueue {
 public:
  explicit FrameQueue(std::size_t capacity) : capacity_(capacity) {}

  /// Adds a frame; when the queue is full, the oldest is dropped and counted. Ignored after an end.
  void push(RgbdFrame frame) {
    const std::lock_guard lock(mutex_);
    if (ended_) return;
    if (frames_.size() >= capacity_) {
      frames_.pop_front();
      ++dropped_;
    }
    frames_.push_back(std::move(frame));
    changed_.notify_all();
  }

  /// Waits until the consumer has nothing to do and asks for a frame; false after an end.
  bool wait_for_demand() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return ended_ || (frames_.empty() && demanded_); });
    return !ended_;
  }

  /// Waits for the oldest frame; nothing when the queue has ended and is empty.
  std::optional<RgbdFrame> pop() {
    std::unique_lock lock(mutex_);
    demanded_ = true;
    changed_.notify_all();
    changed_.wait(lock, [&] { return ended_ || !frames_.empty(); });
    demanded_ = false;
    if (frames_.empty()) return std::nullopt;
    RgbdFrame frame = std::move(frames_.front());
    frames_.pop_front();
    return frame;
  }

  /// No more frames will come; those that wait are still handed out.
  void end() {
    const std::lock_guard lock(mutex_);
    ended_ = true;
    changed_.notify_all();
  }

  /// Ends and forgets those that wait.
  void abort() {
    const std::lock_guard lock(mutex_);
    ended_ = true;
    frames_.clear();
    changed_.notify_all();
  }

  std::uint64_t dropped() const {
    const std::lock_guard lock(mutex_);
    return dropped_;
  }

 private:
  const std::size_t capacity_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<RgbdFrame> frames_;
  std::uint64_t dropped_ = 0;
  bool demanded_ = false;
  bool ended_ = false;
};

}  // namespace sextant
