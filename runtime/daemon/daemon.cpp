// SPDX-License-Identifier: Apache-2.0
#include "runtime/daemon/daemon.h"

#include <fmt/format.h>
#include <pthread.h>
#include <spdlog/spdlog.h>

#include <cerrno>

#include "runtime/base/rate_limiter.h"
#include "runtime/daemon/service_notifier.h"

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

/// Tells the log what became of frames, at a limited rate, and systemd that they pass.
class Reporter {
 public:
  void ready() const { notifier_.ready(); }
  void stopping() const { notifier_.stopping(); }

  void frame(const FrameReport& report) {
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
        p.published, s.delivered, describe_drops(s), p.dropped, p.stale, p.too_old, p.failed, d.timeouts);
    spdlog::info(line);
    notifier_.status(line);
  }

 private:
  ServiceNotifier notifier_;
  RateLimiter limiter_{5, std::chrono::seconds(10)};
  Clock::time_point last_statistics_ = Clock::now();
};

}  // namespace

SignalWaiter::SignalWaiter() {
  sigemptyset(&waited_for_);
  sigaddset(&waited_for_, SIGTERM);
  sigaddset(&waited_for_, SIGINT);
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

void run_daemon(FrameSource& source, const DetectFunction& detect, Publisher& publisher,
                SignalWaiter& signals, const DaemonRun& run) {
  Reporter reporter;
  if (run.pipeline.once) {
    // The topics without memory reach only those who already listen.
    const auto end = Clock::now() + run.once_wait;
    while (publisher.matched_readers() == 0 && Clock::now() < end) {
      if (signals.wait(kSlice)) return;
    }
    if (publisher.matched_readers() == 0) spdlog::warn("nobody listens; publishing the frame all the same");
  }
  Pipeline pipeline(
      source, detect, [&](const FrameResult& result) { publisher.publish(result); }, run.pipeline,
      [&](const FrameReport& report) { reporter.frame(report); });
  reporter.ready();
  bool asked_to_end = false;
  while (!asked_to_end && !pipeline.wait(milliseconds(0))) {
    if (const auto signal = signals.wait(kSlice)) {
      spdlog::info("{}: ending", *signal == SIGTERM ? "SIGTERM" : "SIGINT");
      asked_to_end = true;
    }
    reporter.statistics(pipeline, source, publisher, false);
  }
  reporter.stopping();
  pipeline.stop();
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
