// SPDX-License-Identifier: Apache-2.0
#include "runtime/daemon/pipeline.h"

#include <fmt/format.h>

#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>

#include "runtime/base/error.h"
#include "runtime/daemon/frame_queue.h"

namespace sextant {

namespace {

using std::chrono::milliseconds;

/// How long one wait for the source may take.
constexpr milliseconds kSourceSlice{100};
/// After a frame that could not be read: no busy loop where every frame is bad.
constexpr milliseconds kPauseAfterBadFrame{50};
/// A stamp that is further ahead than this is no capture time of this machine's clock.
constexpr double kLargestAdvanceMs = 1000;

/// On the monotonic clock: a wall clock that is set makes no frame old.
double age_ms(const RgbdFrame& frame) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() -
                                                   frame.captured_monotonic)
      .count();
}

}  // namespace

struct Pipeline::Impl {
  FrameSource& source;
  DetectFunction detect;
  PublishFunction publish;
  PipelineOptions options;
  std::function<void(const FrameReport&)> report;
  FrameQueue queue;

  mutable std::mutex mutex;  // guards all below
  mutable std::condition_variable ended;
  PipelineStatistics statistics;
  std::exception_ptr error;
  int running = 2;
  bool stopped = false;

  std::mutex report_mutex;   // one report at a time
  std::mutex publish_mutex;  // held while publishing: stop() waits for it
  std::thread source_thread, detect_thread;

  Impl(FrameSource& s, DetectFunction d, PublishFunction p, const PipelineOptions& o,
       std::function<void(const FrameReport&)> r)
      : source(s),
        detect(std::move(d)),
        publish(std::move(p)),
        options(o),
        report(std::move(r)),
        queue(static_cast<std::size_t>(o.queue_frames)) {}

  bool is_stopped() const {
    const std::lock_guard lock(mutex);
    return stopped;
  }

  void account(const FrameReport& frame) {
    {
      const std::lock_guard lock(mutex);
      if (frame.fate == FrameFate::kPublished) ++statistics.published;
      if (frame.fate == FrameFate::kTooOld) ++statistics.too_old;
      if (frame.fate == FrameFate::kStale) ++statistics.stale;
      if (frame.fate == FrameFate::kFailed) ++statistics.failed;
    }
    const std::lock_guard lock(report_mutex);
    report(frame);
  }

  /// The first error is the one that rethrow_error() throws.
  void end_with(std::exception_ptr reason) {
    const std::lock_guard lock(mutex);
    if (!error) error = std::move(reason);
    stopped = true;
  }

  void fail_frame(std::int64_t sequence, const std::exception& reason) {
    account({FrameFate::kFailed, sequence, 0, 0, reason.what()});
    if (options.once) end_with(std::current_exception());
  }

  void read_frames() {
    while (!is_stopped()) {
      if (options.skip_none && !queue.wait_for_demand()) return;
      try {
        if (auto frame = source.next(kSourceSlice)) {
          queue.push(std::move(*frame));
          if (options.once) return;
        } else if (source.state() == SourceState::kEnded) {
          return;
        }
      } catch (const InputError& bad_frame) {
        fail_frame(-1, bad_frame);
        std::this_thread::sleep_for(kPauseAfterBadFrame);
      }
    }
  }

  void work_on_frames() {
    while (auto frame = queue.pop()) {
      if (is_stopped()) return;
      try {
        work_on(*frame);
      } catch (const DeviceError&) {
        throw;
      } catch (const std::exception& bad_frame) {
        fail_frame(frame->sequence, bad_frame);
      }
    }
  }

  void work_on(const RgbdFrame& frame) {
    if (frame.captured_at.time_since_epoch().count() <= 0 ||
        frame.captured_monotonic.time_since_epoch().count() <= 0) {
      throw InputError("source", "a frame has no capture time", "the source must stamp every frame");
    }
    const double waited_ms = age_ms(frame);
    if (waited_ms < -kLargestAdvanceMs) {
      throw InputError("source", "a frame's capture time lies in the future", "check the clocks");
    }
    if (options.max_frame_age_ms > 0 && waited_ms > options.max_frame_age_ms) {
      return end_once({FrameFate::kStale, frame.sequence, 0, waited_ms,
                       fmt::format("{:.0f} ms old before it could be searched, allowed are {:.0f} "
                                   "(pipeline.max_frame_age_ms)",
                                   waited_ms, options.max_frame_age_ms)});
    }
    const FrameResult result = detect(frame);
    FrameReport story{FrameFate::kPublished, result.sequence, static_cast<int>(result.estimates.size()),
                      age_ms(frame)};
    if (story.age_ms > options.max_age_ms) {
      story.fate = FrameFate::kTooOld;
      story.reason = fmt::format("{:.0f} ms old, allowed are {:.0f} (pipeline.max_age_ms)", story.age_ms,
                                 options.max_age_ms);
    } else {
      const std::lock_guard lock(publish_mutex);
      if (is_stopped()) return;
      publish(result);
    }
    end_once(story);
  }

  /// Accounts for a frame; with `once`, one that came too late is the program's error.
  void end_once(const FrameReport& story) {
    account(story);
    if (options.once && story.fate != FrameFate::kPublished) {
      end_with(std::make_exception_ptr(InputError("the frame", story.reason, "raise the limit")));
    }
  }

  /// The body of each thread.
  void run(void (Impl::*body)()) {
    try {
      (this->*body)();
    } catch (...) {
      end_with(std::current_exception());
      queue.abort();
      source.close();
    }
    queue.end();
    const std::lock_guard lock(mutex);
    --running;
    ended.notify_all();
  }
};

Pipeline::Pipeline(FrameSource& source, DetectFunction detect, PublishFunction publish,
                   const PipelineOptions& options, std::function<void(const FrameReport&)> report)
    : impl_(
          std::make_unique<Impl>(source, std::move(detect), std::move(publish), options, std::move(report))) {
  impl_->source_thread = std::thread([this] { impl_->run(&Impl::read_frames); });
  impl_->detect_thread = std::thread([this] { impl_->run(&Impl::work_on_frames); });
}

Pipeline::~Pipeline() {
  stop();
  impl_->source_thread.join();
  impl_->detect_thread.join();
}

bool Pipeline::wait(std::chrono::milliseconds timeout) const {
  std::unique_lock lock(impl_->mutex);
  return impl_->ended.wait_for(lock, timeout, [&] { return impl_->running == 0; });
}

void Pipeline::stop() {
  {
    const std::lock_guard lock(impl_->mutex);
    impl_->stopped = true;
  }
  impl_->queue.abort();
  impl_->source.close();
  const std::lock_guard wait_for_publication(impl_->publish_mutex);
}

PipelineStatistics Pipeline::statistics() const {
  const std::lock_guard lock(impl_->mutex);
  PipelineStatistics statistics = impl_->statistics;
  statistics.dropped = impl_->queue.dropped();
  return statistics;
}

void Pipeline::rethrow_error() const {
  const std::lock_guard lock(impl_->mutex);
  if (impl_->error) std::rethrow_exception(impl_->error);
}

}  // namespace sextant
