// SPDX-License-Identifier: Apache-2.0
// What the pipeline and DDS add between capture and subscriber: frames of 640 x 480 at 30 Hz through the
// daemon's real pipeline and publisher with a detection that takes no time, over loopback UDP to a reader in
// another thread.
//   dds_latency_bench [FRAMES]      default 300 (10 s)
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <map>
#include <mutex>
#include <thread>

#include "runtime/daemon/latency_window.h"
#include "runtime/daemon/pipeline.h"
#include "runtime/publish/message_types.h"
#include "runtime/publish/publisher.h"
#include "tests/unit/runtime/publish/dds_test_domain.h"
#include "tests/unit/runtime/publish/example_result.h"
#include "tests/unit/runtime/publish/raw_reader.h"

namespace sextant {
namespace {

using Clock = std::chrono::steady_clock;

/// A camera of 30 Hz.
class Ticker : public FrameSource {
 public:
  explicit Ticker(int frames) : frames_(frames), next_(Clock::now()) {}
  std::optional<RgbdFrame> next(std::chrono::milliseconds) override {
    if (sent_ >= frames_) return std::nullopt;
    std::this_thread::sleep_until(next_);
    next_ += std::chrono::nanoseconds(33'333'333);
    RgbdFrame frame;
    frame.colour = colour_;
    frame.axial_depth_m = depth_;
    const CaptureStamp now = read_clocks();
    frame.captured_at = now.realtime;
    frame.captured_monotonic = now.monotonic;
    frame.sequence = sent_++;
    return frame;
  }
  SourceState state() const override {
    return sent_ >= frames_ ? SourceState::kEnded : SourceState::kRunning;
  }
  SourceStatistics statistics() const override { return {}; }
  void close() override {}

 private:
  int frames_;
  std::atomic<int> sent_ = 0;
  Clock::time_point next_;
  cv::Mat colour_{480, 640, CV_8UC3, cv::Scalar(1, 2, 3)};
  cv::Mat depth_{480, 640, CV_32FC1, cv::Scalar(1)};
};

int run(int frames) {
  const DdsTestDomain domain;
  PublisherOptions options;
  options.domain = domain.writing;
  options.name_space = domain.name_space;
  Publisher publisher(options);
  const QosPointer qos = make_qos({.reliable = true, .depth = 10});
  const RawReader reader(domain.reading, *topic_type<PoseEstimateArrayMessage>().descriptor,
                         "rt/" + domain.name_space + "/pose_estimates", qos.get());
  if (!publisher.wait_for_reader(std::chrono::seconds(20))) return 1;

  std::mutex mutex;
  std::map<std::int64_t, Clock::time_point> captured;
  std::vector<double> delays_ms;
  std::atomic<bool> stop = false;
  std::thread subscriber([&] {
    const dds_entity_t waitset = dds_create_waitset(reader.participant.get());
    const dds_entity_t unread = dds_create_readcondition(reader.reader, DDS_ANY_STATE);
    dds_waitset_attach(waitset, unread, 0);
    while (!stop) {
      dds_attach_t triggered = 0;
      dds_waitset_wait(waitset, &triggered, 1, DDS_MSECS(100));
      void* sample = nullptr;
      dds_sample_info_t info{};
      while (dds_take(reader.reader, &sample, &info, 1, 1) > 0) {
        const auto now = Clock::now();
        if (info.valid_data) {
          const std::lock_guard lock(mutex);
          const auto sequence = static_cast<const PoseEstimateArrayMessage*>(sample)->frame_number;
          delays_ms.push_back(std::chrono::duration<double, std::milli>(now - captured[sequence]).count());
        }
        dds_return_loan(reader.reader, &sample, 1);
        sample = nullptr;
      }
    }
  });
  Ticker source(frames);
  FrameResult found = random_result(1, 3);
  {
    const Pipeline pipeline(
        source,
        [&](const RgbdFrame& frame) {
          const std::lock_guard lock(mutex);
          captured[frame.sequence] = frame.captured_monotonic;
          FrameResult result = found;
          result.captured_at = frame.captured_at;
          result.sequence = frame.sequence;
          return result;
        },
        [&](const FrameResult& result, const RgbdFrame&) { publisher.publish(result); }, {},
        [](const FrameReport&) {});
    while (!pipeline.wait(std::chrono::milliseconds(100))) {
    }
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  stop = true;
  subscriber.join();
  LatencyWindow window;
  for (const double delay : delays_ms) window.add(delay);
  const LatencySummary s = window.summary();
  fmt::print(
      "capture to subscriber without detection: {} of {} frames, median {:.3f} ms, 95 % {:.3f} ms, worst "
      "{:.3f} ms\n",
      delays_ms.size(), frames, s.median, s.p95, s.largest);
  return 0;
}

}  // namespace
}  // namespace sextant

int main(int argc, char** argv) { return sextant::run(argc > 1 ? std::atoi(argv[1]) : 300); }
