// SPDX-License-Identifier: Apache-2.0
#include "hal/dds/dds_image_source.h"

#include <fmt/format.h>

#include <atomic>
#include <mutex>

#include "hal/wait_loop.h"
#include "idl/dds/type_hashes.h"
#include "runtime/base/error.h"

namespace sextant {
namespace {

using Clock = WaitClock;

constexpr std::chrono::seconds kSilence{1};

SubscriptionOptions subscription_of(const DdsImageOptions& options) {
  SubscriptionOptions s;
  s.topic = options.topic;
  s.type = &sensor_msgs_msg_dds__Image__desc;
  s.type_hash = kTypeHashImage;
  s.starved_after = options.starved_after;
  return s;
}

class DdsImageSource final : public ImageSource {
 public:
  DdsImageSource(std::shared_ptr<const DdsParticipant> participant, const DdsImageOptions& options)
      : options_(options), subscription_(std::move(participant), subscription_of(options)) {}

  std::optional<RawImage> next(std::chrono::milliseconds timeout) override {
    auto newest = wait_for_result(timeout, closed_, [this](Clock::time_point deadline) {
      std::optional<RawImage> got;
      subscription_.wait_and_take(left_until(deadline), [&](const void* sample) { accept(sample, got); });
      note(got.has_value());
      return got;
    });
    if (closed_) return std::nullopt;
    if (newest) {
      const std::lock_guard lock(mutex_);
      newest->sequence = sequence_++;
      ++statistics_.delivered;
    }
    return newest;
  }

  SourceState state() const override {
    if (closed_) return SourceState::kEnded;
    const std::lock_guard lock(mutex_);
    return silent_ ? SourceState::kWaiting : SourceState::kRunning;
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
    subscription_.wake();
  }

  std::string name() const override { return "dds " + options_.topic; }

 private:
  /// Never throws: a bad message is counted.
  void accept(const void* sample, std::optional<RawImage>& newest) {
    try {
      const CaptureStamp clocks = read_clocks();
      RawImage image =
          raw_image_of(*static_cast<const ImageMessage*>(sample), options_.kind, clocks, options_.topic);
      if (options_.stamp_on_arrival) image.captured = clocks;
      const auto off = image.captured.realtime - clocks.realtime;
      if (off > options_.believable || off < -options_.believable) {
        drop(DropReason::kBadTime,
             fmt::format(
                 "stamps of {} are {:.1f} s off our clock; synchronise the clocks, or stamp on arrival",
                 options_.topic, std::chrono::duration<double>(off).count()));
        return;
      }
      if (newest) drop(DropReason::kSuperseded, "");
      newest = std::move(image);
    } catch (const std::exception& error) {
      drop(DropReason::kDamaged, error.what());
    }
  }

  void drop(DropReason reason, const std::string& why) {
    const std::lock_guard lock(mutex_);
    ++statistics_.drop(reason);
    if (!why.empty()) refusal_ = why;
  }

  /// After a wait: whether the topic is silent, and why.
  void note(bool heard) {
    const std::string waiting_for = heard ? "" : subscription_.condition();
    const std::lock_guard lock(mutex_);
    const auto now = Clock::now();
    if (heard) {
      last_ = now;
      refusal_.clear();
    }
    silent_ = now - last_ > kSilence;
    statistics_.reconnects = subscription_.recreated();
    condition_ = !refusal_.empty()      ? refusal_
                 : !silent_             ? ""
                 : !waiting_for.empty() ? waiting_for
                                        : options_.topic + " is silent";
  }

  const DdsImageOptions options_;
  Subscription subscription_;
  std::atomic<bool> closed_{false};

  mutable std::mutex mutex_;
  SourceStatistics statistics_;
  std::int64_t sequence_ = 0;
  std::string condition_, refusal_;
  bool silent_ = false;
  Clock::time_point last_ = Clock::now();
};

}  // namespace

std::unique_ptr<ImageSource> open_dds_images(std::shared_ptr<const DdsParticipant> participant,
                                             const DdsImageOptions& options) {
  return std::make_unique<DdsImageSource>(std::move(participant), options);
}

}  // namespace sextant
