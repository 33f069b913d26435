// SPDX-License-Identifier: Apache-2.0
#include "runtime/daemon/daemon.h"

#include <fmt/format.h>
#include <pthread.h>
#include <spdlog/spdlog.h>

#include <future>
#include <mutex>

#include "runtime/base/error.h"
#include "runtime/base/rate_limiter.h"
#include "runtime/daemon/health.h"
#include "runtime/daemon/service_notifier.h"
#include "runtime/daemon/temperatures.h"

namespace sextant {

namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

constexpr milliseconds kSlice{50};
/// From the signal to leaving: within a second, whatever runs.
constexpr milliseconds kPatienceAtTheEnd{700};
constexpr std::chrono::seconds kStatusPeriod{10};
/// After the acknowledgements: best-effort readers acknowledge nothing.
constexpr milliseconds kLingerAfterOnce{200};

/// Tells the log what became of frames, at a limited rate, systemd that they pass, and both and the
/// diagnostics topic how we are.
class Reporter {
 public:
  explicit Reporter(const DaemonRun& run)
      : health_(run.hardware_id), period_(run.diagnostics_period), max_age_ms_(run.pipeline.max_age_ms) {}
  void ready() const { notifier_.ready(); }
  void stopping() const { notifier_.stopping(); }
  void reloading() const { notifier_.reloading(); }

  void result(const FrameResult& result) {
    const std::lock_guard lock(mutex_);
    health_.result(result);
  }

  void frame(const FrameReport& report) {
    const std::lock_guard lock(mutex_);
    health_.frame(report);
    std::uint64_t held_back = 0;
    if (report.fate == FrameFate::kPublished) {
      spdlog::debug("frame {}: {} poses, {:.0f} ms after capture", report.sequence, report.poses,
                    report.age_ms);
    } else if (limiter_.pass(Clock::now(), held_back)) {
      const std::string more = held_back > 0 ? fmt::format(" ({} such lines held back)", held_back) : "";
      if (report.fate == FrameFate::kTooOld) {
        spdlog::warn("frame {}: result not published, {}{}", report.sequence, report.reason, more);
      } else if (report.fate == FrameFate::kStale) {
        spdlog::warn("frame {}: not searched, {}{}", report.sequence, report.reason, more);
      } else {
        spdlog::error("frame failed: {}{}", report.reason, more);
      }
    }
    // A frame that fails is no progress; one that is only late is.
    if (report.fate != FrameFate::kFailed) notifier_.progress();
  }

  /// A source that waits for its device, says so and still answers is not stuck: starting again would not
  /// help.
  void waiting(const Pipeline& pipeline, const FrameSource& source) {
    const std::lock_guard lock(mutex_);
    const std::uint64_t asked = pipeline.statistics().asked;
    const bool answered = asked != asked_;
    asked_ = asked;
    const bool waits = source.state() == SourceState::kWaiting;
    if (waits && answered) notifier_.progress();
    if (waits == waits_) return;
    waits_ = waits;
    const std::string text = source.condition();
    if (waits) {
      spdlog::warn("waiting for frames: {}", text);
    } else {
      spdlog::info("frames come again: {}", text);
    }
    notifier_.status(waits ? "waiting for frames: " + text : "frames come");
  }

  void diagnostics(const Pipeline& pipeline, const FrameSource& source, Publisher& publisher) {
    const Clock::time_point now = Clock::now();
    if (now - last_report_ < period_) return;
    HealthInput input;
    input.pipeline = pipeline.statistics();
    input.source = source.statistics();
    input.source_state = source.state();
    input.source_condition = source.condition();
    input.publisher = publisher.statistics();
    input.readers = publisher.matched_readers();
    input.max_age_ms = max_age_ms_;
    input.temperatures_celsius = read_temperatures();
    DiagnosticReport report;
    {
      const std::lock_guard lock(mutex_);
      report = health_.report(input, std::chrono::duration<double>(now - last_report_).count(),
                              std::chrono::system_clock::now());
    }
    last_report_ = now;
    publisher.publish_diagnostics(report);
  }

  /// Every ten seconds, and at the end.
  void statistics(const Pipeline& pipeline, const FrameSource& source, const Publisher& publisher, bool now) {
    if (!now && Clock::now() - last_statistics_ < kStatusPeriod) return;
    last_statistics_ = Clock::now();
    const PipelineStatistics p = pipeline.statistics();
    const SourceStatistics s = source.statistics();
    const PublisherStatistics d = publisher.statistics();
    const std::string line = fmt::format(
        "{} frames published; {} from the source (dropped: {}), {} dropped while waiting, {} stale, {} too "
        "old, {} failed, {} writes timed out",
        p.published, s.delivered, describe_drops(s), p.dropped + p.unpublished, p.stale, p.too_old, p.failed,
        d.timeouts);
    spdlog::info(line);
    notifier_.status(line);
  }

 private:
  std::mutex mutex_;  // of the frames' side: health_, limiter_, notifier_'s watchdog
  ServiceNotifier notifier_;
  Health health_;
  std::chrono::milliseconds period_;
  double max_age_ms_;
  Clock::time_point last_report_ = Clock::now();
  std::uint64_t asked_ = 0;
  bool waits_ = false;
  RateLimiter limiter_{5, std::chrono::seconds(10)};
  Clock::time_point last_statistics_ = Clock::now();
};

}  // namespace

SignalWaiter::SignalWaiter() {
  sigemptyset(&waited_for_);
  sigaddset(&waited_for_, SIGTERM);
  sigaddset(&waited_for_, SIGINT);
  sigaddset(&waited_for_, SIGHUP);
  pthread_sigmask(SIG_BLOCK, &waited_for_, &old_);
}

SignalWaiter::~SignalWaiter() {
  while (wait(milliseconds(0))) {
    // An impatient second signal has been answered too.
  }
  pthread_sigmask(SIG_SETMASK, &old_, nullptr);
}

std::optional<int> SignalWaiter::wait(milliseconds timeout) {
  const timespec limit{static_cast<time_t>(timeout.count() / 1000),
                       static_cast<long>(timeout.count() % 1000) * 1'000'000};
  const int signal = sigtimedwait(&waited_for_, nullptr, &limit);
  return signal > 0 ? std::optional(signal) : std::nullopt;
}

namespace {

/// SIGHUP, done beside the loop that waits for signals: reading models takes its time, and SIGTERM must not
/// wait for it.
class Reloading {
 public:
  Reloading(const DaemonRun& run, const Reporter& reporter) : run_(run), reporter_(reporter) {}

  void ask() { asked_ = static_cast<bool>(run_.reload); }
  /// Begins what was asked for, when nothing of it is under way.
  void go_on() {
    if (!asked_ || (task_.valid() && task_.wait_for(milliseconds(0)) != std::future_status::ready)) return;
    asked_ = false;
    task_ = std::async(std::launch::async, [this] { reload(); });
  }

 private:
  void reload() const {
    reporter_.reloading();
    try {
      spdlog::info("SIGHUP: {}", run_.reload());
    } catch (const std::exception& error) {
      spdlog::error("SIGHUP: nothing has changed: {}", error.what());
    }
    reporter_.ready();
  }

  const DaemonRun& run_;
  const Reporter& reporter_;
  bool asked_ = false;
  std::future<void> task_;  // waits for its end when it is destroyed
};

/// The topics without memory reach only those who already listen. False: a signal came.
bool wait_for_listener(const Publisher& publisher, SignalWaiter& signals, milliseconds patience) {
  const auto end = Clock::now() + patience;
  while (publisher.matched_readers() == 0 && Clock::now() < end) {
    if (signals.wait(kSlice)) return false;
  }
  if (publisher.matched_readers() == 0) spdlog::warn("nobody listens; publishing the frame all the same");
  return true;
}

}  // namespace

void run_daemon(FrameSource& source, const DetectFunction& detect, Publisher& publisher,
                SignalWaiter& signals, const DaemonRun& run) {
  Reporter reporter(run);
  if (run.pipeline.once && !wait_for_listener(publisher, signals, run.once_wait)) return;
  const auto publish = [&](const FrameResult& result, const RgbdFrame& frame) {
    const auto age_s = [&] {
      return std::chrono::duration<double>(Clock::now() - frame.captured_monotonic).count();
    };
    publisher.publish(result, age_s());
    if (run.draw && publisher.annotated_wanted()) {
      const cv::Mat drawn = run.draw(frame, result);
      publisher.publish_annotated(result, drawn, age_s());
    }
    reporter.result(result);
  };
  Pipeline pipeline(source, detect, publish, run.pipeline,
                    [&](const FrameReport& report) { reporter.frame(report); });
  reporter.ready();
  Reloading reloading(run, reporter);
  bool asked_to_end = false;
  while (!asked_to_end && !pipeline.wait(milliseconds(0))) {
    const auto signal = signals.wait(kSlice);
    if (signal && *signal == SIGHUP) {
      reloading.ask();
    } else if (signal) {
      spdlog::info("{}: ending", *signal == SIGTERM ? "SIGTERM" : "SIGINT");
      asked_to_end = true;
      if (run.ending) run.ending();
    }
    reloading.go_on();
    reporter.waiting(pipeline, source);
    reporter.diagnostics(pipeline, source, publisher);
    reporter.statistics(pipeline, source, publisher, false);
  }
  reporter.stopping();
  pipeline.stop();
  if (run.cancel) run.cancel();
  const bool ended = pipeline.wait(kPatienceAtTheEnd);
  reporter.statistics(pipeline, source, publisher, true);
  if (!ended) {
    spdlog::info("a detection is still under way; its result is abandoned");
    run.abandon();
  }
  pipeline.rethrow_error();
  if (run.pipeline.once && !asked_to_end) {
    if (!publisher.wait_for_acknowledgements(run.once_wait))
      spdlog::warn("not every reader acknowledged the frame");
    signals.wait(kLingerAfterOnce);
  }
}

}  // namespace sextant
