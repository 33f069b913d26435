// SPDX-License-Identifier: Apache-2.0
#include "hal/live/live_source.h"

#include <fmt/format.h>

#include <atomic>
#include <mutex>
#include <utility>

#include "hal/live/backoff.h"
#include "hal/live/device_clock.h"
#include "hal/live/sequence_counter.h"
#include "hal/live/wake_event.h"
#include "hal/wait_loop.h"

namespace sextant {
namespace {

using Clock = WaitClock;
using std::chrono::milliseconds;

/// Some devices fail to start once and then work.
constexpr int kFirstTries = 3;

class LiveSource final : public ImageSource {
 public:
  LiveSource(std::string name, const StreamOptions& options, OpenSession open)
      : name_(std::move(name)), options_(options), open_(std::move(open)) {
    for (int tries = 1; !session_; ++tries) {
      try {
        session_ = open_();
        session_began();
      } catch (const DeviceUnready& unready) {
        if (tries < kFirstTries) {
          wake_.wait(-1, Clock::now() + backoff_.next());
        } else if (options_.wait_for_device) {
          wait_for(unready.what());
          return;
        } else {
          throw;
        }
      }
    }
  }

  std::optional<RawImage> next(milliseconds timeout) override {
    auto image = wait_for_result(timeout, closed_, [this](Clock::time_point end) { return attempt(end); });
    if (closed_) session_.reset();
    return image;
  }

  SourceState state() const override {
    if (closed_) return SourceState::kEnded;
    return waiting_ ? SourceState::kWaiting : SourceState::kRunning;
  }

  std::string condition() const override {
    const std::lock_guard lock(mutex_);
    return condition_;
  }

  SourceStatistics statistics() const override {
    const std::lock_guard lock(mutex_);
    return statistics_;
  }

  void close() override {
    closed_ = true;
    wake_.set();
  }

  std::string name() const override { return name_; }

 private:
  void count(DropReason reason, std::uint64_t number = 1) {
    const std::lock_guard lock(mutex_);
    statistics_.drop(reason) += number;
  }

  void say(std::string condition) {
    const std::lock_guard lock(mutex_);
    condition_ = std::move(condition);
  }

  void session_began() {
    last_good_ = Clock::now();
    numbers_.restart();
    if (!waiting_) say(session_->description());
  }

  void wait_for(const std::string& reason) {
    waiting_ = true;
    say(reason);
    retry_at_ = Clock::now() + backoff_.next();
  }

  void end_session(const std::string& reason) {
    session_.reset();
    wait_for(fmt::format("{}: {}; opening it anew", name_, reason));
  }

  /// An image that is there, or a wait for one.
  std::optional<RawImage> attempt(Clock::time_point deadline) {
    if (!session_) try_to_open(deadline);
    if (!session_) return std::nullopt;
    if (auto image = take_newest()) return image;
    if (!session_) return std::nullopt;
    const bool starved = session_->is_starved();
    if (starved) last_good_ = Clock::now();
    const Clock::time_point silent_at = last_good_ + options_.watchdog;
    if (Clock::now() >= silent_at) {
      end_session(fmt::format("no good frame for {} ms", options_.watchdog.count()));
    } else {
      wake_.wait(session_->wait_fd(), starved ? deadline : std::min(deadline, silent_at));
    }
    return std::nullopt;
  }

  /// One try, when its time has come; session_ tells.
  void try_to_open(Clock::time_point deadline) {
    wake_.wait(-1, std::min(deadline, retry_at_));
    if (closed_ || Clock::now() < retry_at_) return;
    try {
      session_ = open_();
      session_began();
    } catch (const DoorError& error) {
      wait_for(error.what());
    }
  }

  /// Works off what has arrived. The image to hand out, or nothing; the session may be over afterwards.
  std::optional<RawImage> take_newest() {
    std::optional<RawImage> newest;
    for (;;) {
      Arrival arrival = session_->take();
      switch (arrival.kind) {
        case Arrival::Kind::kNothing:
          return hand_out(std::move(newest));
        case Arrival::Kind::kGone:
          end_session(arrival.reason);
          return hand_out(std::move(newest));
        case Arrival::Kind::kDamaged:
          count(DropReason::kLost, numbers_.next(arrival.device_sequence).lost);
          count(DropReason::kDamaged);
          break;
        case Arrival::Kind::kImage:
          if (auto image = accept(std::move(arrival))) {
            if (newest) count(DropReason::kSuperseded);
            newest = std::move(image);
            if (!options_.newest_only) return hand_out(std::move(newest));
          }
      }
    }
  }

  /// Gives an image its number and time; nothing where it has none or is stale.
  std::optional<RawImage> accept(Arrival arrival) {
    const CaptureStamp now = read_clocks();
    const SequenceCounter::Step step = numbers_.next(arrival.device_sequence);
    count(DropReason::kLost, step.lost);
    last_good_ = now.monotonic;
    const auto captured = clock_.capture_time(arrival.device_time, now.monotonic);
    if (!captured) {
      count(DropReason::kBadTime);
      return std::nullopt;
    }
    if (options_.max_age.count() > 0 && now.monotonic - *captured > options_.max_age) {
      count(DropReason::kStale);
      return std::nullopt;
    }
    arrival.image.captured = stamp_of(*captured, now);
    arrival.image.sequence = step.sequence;
    return std::move(arrival.image);
  }

  std::optional<RawImage> hand_out(std::optional<RawImage> image) {
    if (!image) return image;
    backoff_.reset();
    const std::lock_guard lock(mutex_);
    ++statistics_.delivered;
    if (session_ && waiting_) {
      waiting_ = false;
      if (had_frames_) ++statistics_.reconnects;
      condition_ = session_->description();
    }
    had_frames_ = true;
    return image;
  }

  const std::string name_;
  const StreamOptions options_;
  const OpenSession open_;
  const WakeEvent wake_;
  std::atomic<bool> closed_ = false;
  std::atomic<bool> waiting_ = false;

  // Of the thread that calls next().
  std::unique_ptr<StreamSession> session_;
  Backoff backoff_;
  DeviceClock clock_;
  SequenceCounter numbers_;
  bool had_frames_ = false;
  Clock::time_point last_good_{};
  Clock::time_point retry_at_{};

  // Shared with whoever asks.
  mutable std::mutex mutex_;
  std::string condition_;
  SourceStatistics statistics_;
};

}  // namespace

std::unique_ptr<ImageSource> make_live_source(std::string name, const StreamOptions& options,
                                              OpenSession open) {
  return std::make_unique<LiveSource>(std::move(name), options, std::move(open));
}

}  // namespace sextant
