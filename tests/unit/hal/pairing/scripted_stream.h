// SPDX-License-Identifier: Apache-2.0
// An ImageSource that delivers what a test pushes into it, from any thread.
#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <utility>
#include <vector>

#include "hal/image_source.h"

namespace sextant {

/// What a test holds of a stream that the source under test owns.
class StreamScript {
 public:
  void push(RawImage image) {
    change([&] { images_.push_back(std::move(image)); });
  }
  void fail(std::exception_ptr error) {
    change([&] { error_ = std::move(error); });
  }
  void end() {
    change([&] { ended_ = true; });
  }
  void set_state(SourceState state, std::string condition) {
    change([&] {
      state_ = state;
      condition_ = std::move(condition);
    });
  }
  SourceStatistics own_statistics;

 private:
  friend class ScriptedStream;
  template <typename Change>
  void change(Change apply) {
    const std::lock_guard lock(mutex_);
    apply();
    changed_.notify_all();
  }
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<RawImage> images_;
  std::exception_ptr error_;
  bool ended_ = false;
  bool closed_ = false;
  SourceState state_ = SourceState::kRunning;
  std::string condition_;
};

class ScriptedStream final : public ImageSource {
 public:
  ScriptedStream(std::shared_ptr<StreamScript> script, std::string name)
      : script_(std::move(script)), name_(std::move(name)) {}

  std::optional<RawImage> next(std::chrono::milliseconds timeout) override {
    StreamScript& s = *script_;
    std::unique_lock lock(s.mutex_);
    s.changed_.wait_for(lock, timeout,
                        [&] { return s.closed_ || s.ended_ || s.error_ || !s.images_.empty(); });
    if (!s.images_.empty()) {
      RawImage image = std::move(s.images_.front());
      s.images_.pop_front();
      return image;
    }
    if (s.error_) std::rethrow_exception(std::exchange(s.error_, nullptr));
    return std::nullopt;
  }
  SourceState state() const override {
    const std::lock_guard lock(script_->mutex_);
    if (script_->closed_ || (script_->ended_ && script_->images_.empty())) return SourceState::kEnded;
    return script_->state_;
  }
  std::string condition() const override {
    const std::lock_guard lock(script_->mutex_);
    return script_->condition_;
  }
  SourceStatistics statistics() const override { return script_->own_statistics; }
  void close() override {
    script_->change([&] { script_->closed_ = true; });
  }
  std::string name() const override { return name_; }

 private:
  std::shared_ptr<StreamScript> script_;
  std::string name_;
};

/// An image of one value in every byte, or in every 16-bit pixel, captured at that time.
inline RawImage image_of(PixelFormat format, int width, int height, unsigned value, MonotonicTime at,
                         std::int64_t sequence) {
  RawImage image;
  image.format = format;
  image.width = width;
  image.height = height;
  image.stride = least_stride(format, width);
  const std::size_t size = image_bytes(format, width, height, image.stride);
  auto bytes = std::make_shared<std::vector<std::byte>>(size, static_cast<std::byte>(value));
  if (format == PixelFormat::kZ16) {
    for (std::size_t i = 0; i + 1 < size; i += 2) {
      (*bytes)[i] = static_cast<std::byte>(value & 0xFF);
      (*bytes)[i + 1] = static_cast<std::byte>(value >> 8);
    }
  }
  image.bytes = *bytes;
  image.buffer = bytes;
  image.captured = stamp_of(at, read_clocks());
  image.sequence = sequence;
  return image;
}

}  // namespace sextant
