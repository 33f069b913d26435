// SPDX-License-Identifier: Apache-2.0
#include "hal/playback/playback_source.h"

#include <algorithm>

#include "runtime/base/error.h"

namespace sextant {
namespace {

using Time = PlaybackClock::Time;
using Duration = Time::duration;

Duration seconds(double s) { return std::chrono::duration_cast<Duration>(std::chrono::duration<double>(s)); }

/// A pause in a recording is played, but not a night.
constexpr std::chrono::minutes kLongestPause{10};

class PlaybackSource final : public FrameSource {
 public:
  PlaybackSource(std::unique_ptr<FrameReel> reel, const PlaybackOptions& options)
      : reel_(std::move(reel)), options_(options) {
    for (const std::string& remark : reel_->remarks())
      condition_ += (condition_.empty() ? "" : "; ") + remark;
  }

  std::optional<RgbdFrame> next(std::chrono::milliseconds timeout) override {
    const Time deadline = options_.clock->now() + timeout;
    if (!prefetch()) return std::nullopt;
    const Duration interval = pending_interval_;
    Time now = options_.clock->now();
    if (interval > Duration::zero()) {
      const Time due = last_ + interval;
      std::unique_lock lock(mutex_);
      options_.clock->wait(lock, closing_, std::min(due, deadline), [this] { return closed_; });
      now = options_.clock->now();
      if (closed_ || now < due) return std::nullopt;
      // On time: keep the beat. Late: start a new one.
      now = now - due < interval ? due : now;
    }
    last_ = now;
    RgbdFrame frame = std::move(*pending_);
    pending_.reset();
    const bool no_time = frame.captured_at == CaptureTime{};
    if (options_.restamp || no_time) {
      const CaptureStamp stamp = read_clocks();
      frame.captured_at = stamp.realtime;
      frame.captured_monotonic = stamp.monotonic;
    }
    if (!options_.frame_id.empty()) frame.frame_id = options_.frame_id;
    const std::lock_guard lock(mutex_);
    if (closed_) return std::nullopt;
    if (options_.restamp || no_time) frame.sequence = static_cast<std::int64_t>(statistics_.delivered);
    ++statistics_.delivered;
    ended_ = !options_.loop && cursor_ == reel_->size();
    return frame;
  }

  SourceState state() const override {
    const std::lock_guard lock(mutex_);
    return closed_ || ended_ ? SourceState::kEnded : SourceState::kRunning;
  }

  std::string condition() const override { return condition_; }

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
  /// Reads the frame that is next into pending_; false where there is none.
  bool prefetch() {
    if (state() == SourceState::kEnded) return false;
    if (pending_) return true;
    if (cursor_ == reel_->size()) cursor_ = 0;
    const std::size_t i = cursor_++;  // moved on first: a bad image does not stop the ones after it
    try {
      pending_ = reel_->load(i);
    } catch (...) {
      const std::lock_guard lock(mutex_);
      ++statistics_.drop(DropReason::kDamaged);
      ended_ = !options_.loop && cursor_ == reel_->size();
      throw;
    }
    pending_interval_ = interval_before(i);
    previous_ = i;
    return true;
  }

  /// Time between the frame played before and frame i; 0 for the first one.
  Duration interval_before(std::size_t i) {
    if (!previous_) return Duration::zero();
    if (options_.pace == PlaybackPace::kRate) {
      return options_.rate_hz > 0 ? seconds(1 / options_.rate_hz) : Duration::zero();
    }
    // Round the corner of a loop: as between the first two.
    const bool corner = i <= *previous_;
    const std::size_t from = corner ? 0 : *previous_;
    const std::size_t to = corner ? std::min<std::size_t>(1, reel_->size() - 1) : i;
    const double recorded =
        std::chrono::duration<double>(reel_->captured(to)->monotonic - reel_->captured(from)->monotonic)
            .count();
    // A clock that was set back in the recording: no pause.
    return std::clamp<Duration>(seconds(recorded / options_.speed), Duration::zero(), kLongestPause);
  }

  // Of the thread that calls next().
  const std::unique_ptr<FrameReel> reel_;
  const PlaybackOptions options_;
  std::string condition_;
  std::size_t cursor_ = 0;
  std::optional<std::size_t> previous_;
  std::optional<RgbdFrame> pending_;
  Duration pending_interval_{};
  Time last_{};

  // Shared with whoever calls close(), state(), statistics().
  mutable std::mutex mutex_;
  std::condition_variable closing_;
  bool closed_ = false;
  bool ended_ = false;
  SourceStatistics statistics_;
};

}  // namespace

std::unique_ptr<FrameSource> open_playback(const PlaybackOptions& options) {
  if (!(options.rate_hz >= 0 && options.rate_hz <= 10000)) {
    throw UsageError("the playback rate must lie between 0 and 10000 Hz", "0 plays as fast as possible");
  }
  if (!(options.speed >= 0.01 && options.speed <= 100)) {
    throw UsageError("the playback speed must lie between 0.01 and 100", "1 plays as it was recorded");
  }
  std::unique_ptr<FrameReel> reel = open_reel(options);
  if (options.pace == PlaybackPace::kTimestamps && !reel->captured(0)) {
    throw UsageError(options.dataset.string() + " has no capture times to play by",
                     "give a rate instead; BOP data sets have none");
  }
  return std::make_unique<PlaybackSource>(std::move(reel), options);
}

}  // namespace sextant
