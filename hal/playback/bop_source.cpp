// SPDX-License-Identifier: Apache-2.0
#include "hal/playback/bop_source.h"

#include <condition_variable>
#include <mutex>

#include "hal/playback/bop_dataset.h"
#include "runtime/base/error.h"

namespace sextant {
namespace {

using Clock = std::chrono::steady_clock;

class BopSource final : public FrameSource {
 public:
  BopSource(BopDataset dataset, const BopSourceOptions& options)
      : images_(std::move(dataset.images)),
        period_(options.rate_hz > 0 ? std::chrono::duration_cast<Clock::duration>(
                                          std::chrono::duration<double>(1.0 / options.rate_hz))
                                    : Clock::duration::zero()),
        loop_(options.loop),
        frame_id_(options.frame_id) {}

  std::optional<RgbdFrame> next(std::chrono::milliseconds timeout) override {
    const Clock::time_point deadline = Clock::now() + timeout;
    if (!prefetch()) return std::nullopt;
    if (period_ > Clock::duration::zero() && statistics().delivered > 0) {
      const Clock::time_point due = last_ + period_;
      std::unique_lock lock(mutex_);
      closing_.wait_until(lock, std::min(due, deadline), [this] { return closed_; });
      if (closed_ || Clock::now() < due) return std::nullopt;
      // On time: keep the beat. Late: start a new one.
      last_ = Clock::now() - due < period_ ? due : Clock::now();
    } else {
      last_ = Clock::now();
    }
    RgbdFrame frame = std::move(*pending_);
    pending_.reset();
    const CaptureStamp now = read_clocks();  // a recording has no live capture time
    frame.captured_at = now.realtime;
    frame.captured_monotonic = now.monotonic;
    frame.frame_id = frame_id_;
    const std::lock_guard lock(mutex_);
    if (closed_) return std::nullopt;
    frame.sequence = static_cast<std::int64_t>(statistics_.delivered++);
    ended_ = !loop_ && cursor_ == images_.size();
    return frame;
  }

  SourceState state() const override {
    const std::lock_guard lock(mutex_);
    return closed_ || ended_ ? SourceState::kEnded : SourceState::kRunning;
  }

  SourceStatistics statistics() const override {
    const std::lock_guard lock(mutex_);
    return statistics_;
  }

  void close() override {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    closing_.notify_all();
  }

 private:
  /// Reads the image that is next into pending_; false where there is none.
  bool prefetch() {
    if (state() == SourceState::kEnded) return false;
    if (pending_) return true;
    if (cursor_ == images_.size()) cursor_ = 0;
    const BopImage& image =
        images_[cursor_++];  // moved on first: a bad image does not stop the ones after it
    try {
      pending_ = load_frame(image);
    } catch (...) {
      const std::lock_guard lock(mutex_);
      ++statistics_.drop(DropReason::kDamaged);
      ended_ = !loop_ && cursor_ == images_.size();
      throw;
    }
    return true;
  }

  // Of the thread that calls next().
  const std::vector<BopImage> images_;
  const Clock::duration period_;
  const bool loop_;
  const std::string frame_id_;
  std::size_t cursor_ = 0;
  std::optional<RgbdFrame> pending_;
  Clock::time_point last_{};

  // Shared with whoever calls close(), state(), statistics().
  mutable std::mutex mutex_;
  std::condition_variable closing_;
  bool closed_ = false;
  bool ended_ = false;
  SourceStatistics statistics_;
};

}  // namespace

std::unique_ptr<FrameSource> open_bop_source(const BopSourceOptions& options) {
  if (!(options.rate_hz >= 0 && options.rate_hz <= 10000)) {
    throw UsageError("the playback rate must lie between 0 and 10000 Hz", "0 plays as fast as possible");
  }
  BopDataset dataset = open_bop_dataset(options.dataset, options.split, options.scene);
  if (options.image >= 0) {
    std::erase_if(dataset.images, [&](const BopImage& image) { return image.image_id != options.image; });
    if (dataset.images.empty()) {
      throw InputError((options.dataset / options.split).string(),
                       "holds no image " + std::to_string(options.image),
                       "image numbers are the keys of scene_camera.json");
    }
  }
  return std::make_unique<BopSource>(std::move(dataset), options);
}

}  // namespace sextant
