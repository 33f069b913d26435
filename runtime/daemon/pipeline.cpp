// SPDX-License-Identifier: Apache-2.0
#include "runtime/daemon/pipeline.h"

#include <fmt/format.h>

#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>

#include "runtime/base/error.h"
#include "runtime/daemon/newest_queue.h"

namespace sextant {

namespace {

using std::chrono::milliseconds;

/// How long one wait for the source may take.
constexpr milliseconds kSourceSlice{100};
/// After a frame that could not be read: no busy loop where every frame is bad.
constexpr milliseconds kPauseAfterBadFrame{50};
/// A stamp that is further ahead than this is no capture time of this machine's clock.
constexpr double kLargestAdvanceMs = 1000;

/// Results that may wait for publication.
constexpr std::size_t kWaitingResults = 2;

using Clock = std::chrono::steady_clock;

double ms_between(Clock::time_point from, Clock::time_point to) {
  return std::chrono::duration<double, std::milli>(to - from).count();
}

/// A frame on its way to detection.
struct WaitingFrame {
  RgbdFrame frame;
  Clock::time_point arrived;
};

/// A result on its way to publication.
struct WaitingResult {
  RgbdFrame frame;
  FrameResult result;
  FrameTimes times;
  Clock::time_point ready;
};

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
  NewestQueue<WaitingFrame> queue;
  NewestQueue<WaitingResult> results{kWaitingResults};

  mutable std::mutex mutex;  // guards all below
  mutable std::condition_variable ended;
  PipelineStatistics statistics;
  std::exception_ptr error;
  int running = 3;
  bool stopped = false;

  std::mutex report_mutex;   // one report at a time
  std::mutex publish_mutex;  // held while publishing: stop() waits for it
  std::thread source_thread, detect_thread, publish_thread;

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
      if (options.skip_none && !queue.wait_for_demand()) break;
      try {
        auto frame = source.next(kSourceSlice);
        count_answer();
        if (frame) {
          queue.push({std::move(*frame), Clock::now()});
          if (options.once) break;
        } else if (source.state() == SourceState::kEnded) {
          break;
        }
      } catch (const InputError& bad_frame) {
        count_answer();
        fail_frame(-1, bad_frame);
        std::this_thread::sleep_for(kPauseAfterBadFrame);
      }
    }
    queue.end();
  }

  void count_answer() {
    const std::lock_guard lock(mutex);
    ++statistics.asked;
  }

  void detect_frames() {
    while (auto waiting = queue.pop()) {
      if (is_stopped()) break;
      guard(waiting->frame.sequence, [&] { detect_one(std::move(*waiting)); });
    }
    results.end();
  }

  void publish_results() {
    while (auto waiting = results.pop()) {
      if (is_stopped()) break;
      guard(waiting->frame.sequence, [&] { publish_one(*waiting); });
    }
  }

  /// A device that fails ends everything, anything else only this frame.
  void guard(std::int64_t sequence, const std::function<void()>& work) {
    try {
      work();
    } catch (const DeviceError&) {
      throw;
    } catch (const std::exception& bad_frame) {
      fail_frame(sequence, bad_frame);
    }
  }

  void detect_one(WaitingFrame waiting) {
    const RgbdFrame& frame = waiting.frame;
    if (frame.captured_at.time_since_epoch().count() <= 0 ||
        frame.captured_monotonic.time_since_epoch().count() <= 0) {
      throw InputError("source", "a frame has no capture time", "the source must stamp every frame");
    }
    const double age = age_ms(frame);
    if (age < -kLargestAdvanceMs) {
      throw InputError("source", "a frame's capture time lies in the future", "check the clocks");
    }
    if (options.max_frame_age_ms > 0 && age > options.max_frame_age_ms) {
      return end_once({FrameFate::kStale, frame.sequence, 0, age,
                       fmt::format("{:.0f} ms old before it could be searched, allowed are {:.0f} "
                                   "(pipeline.max_frame_age_ms)",
                                   age, options.max_frame_age_ms)});
    }
    WaitingResult ready;
    ready.times.capture_ms = ms_between(frame.captured_monotonic, waiting.arrived);
    ready.times.waiting_ms = ms_between(waiting.arrived, Clock::now());
    ready.result = detect(frame);
    const StageSeconds& seconds = ready.result.seconds;
    ready.times.features_ms = 1e3 * seconds.features;
    ready.times.tables_ms = 1e3 * seconds.tables;
    ready.times.search_ms = 1e3 * seconds.search;
    ready.times.refine_ms = 1e3 * seconds.refine;
    ready.frame = std::move(waiting.frame);
    ready.ready = Clock::now();
    if (options.skip_none) {
      results.push_when_room(std::move(ready));
    } else {
      results.push(std::move(ready));
    }
  }

  void publish_one(WaitingResult& waiting) {
    const FrameResult& result = waiting.result;
    FrameReport story{FrameFate::kPublished, result.sequence, static_cast<int>(result.estimates.size()),
                      age_ms(waiting.frame)};
    if (story.age_ms > options.max_age_ms) {
      story.fate = FrameFate::kTooOld;
      story.reason = fmt::format("{:.0f} ms old, allowed are {:.0f} (pipeline.max_age_ms)", story.age_ms,
                                 options.max_age_ms);
    } else {
      const std::lock_guard lock(publish_mutex);
      if (is_stopped()) return;
      const Clock::time_point begin = Clock::now();
      waiting.times.handover_ms = ms_between(waiting.ready, begin);
      publish(result, waiting.frame);
      waiting.times.publish_ms = ms_between(begin, Clock::now());
      story.times = waiting.times;
      story.age_ms = age_ms(waiting.frame);
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

  void abort() {
    queue.abort();
    results.abort();
    source.close();
  }

  /// The body of each thread.
  void run(void (Impl::*body)()) {
    try {
      (this->*body)();
    } catch (...) {
      end_with(std::current_exception());
      abort();
    }
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
  impl_->detect_thread = std::thread([this] { impl_->run(&Impl::detect_frames); });
  impl_->publish_thread = std::thread([this] { impl_->run(&Impl::publish_results); });
}

Pipeline::~Pipeline() {
  stop();
  impl_->source_thread.join();
  impl_->detect_thread.join();
  impl_->publish_thread.join();
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
  impl_->abort();
  const std::lock_guard wait_for_publication(impl_->publish_mutex);
}

PipelineStatistics Pipeline::statistics() const {
  const std::lock_guard lock(impl_->mutex);
  PipelineStatistics statistics = impl_->statistics;
  statistics.dropped = impl_->queue.dropped();
  statistics.unpublished = impl_->results.dropped();
  return statistics;
}

void Pipeline::rethrow_error() const {
  const std::lock_guard lock(impl_->mutex);
  if (impl_->error) std::rethrow_exception(impl_->error);
}

}  // namespace sextant
