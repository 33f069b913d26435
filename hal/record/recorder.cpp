// SPDX-License-Identifier: Apache-2.0
#include "hal/record/recorder.h"

#include <fmt/format.h>

#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>

#include "runtime/base/error.h"

namespace sextant {

struct Recorder::Impl {
  std::unique_ptr<FrameSink> sink;
  RecorderOptions options;

  mutable std::mutex mutex;
  std::condition_variable changed;
  std::deque<RgbdFrame> queue;
  RecorderStatistics statistics;
  int failures_in_a_row = 0;
  bool losing = false;   ///< frames are being lost because the queue is full
  bool ending = false;   ///< write what waits, then end
  bool abandon = false;  ///< end at once
  std::thread writer;    // last: uses all of the above

  void say(const std::string& line) const {
    if (options.say) options.say(line);
  }

  void write_all() {
    std::unique_lock lock(mutex);
    for (;;) {
      changed.wait(lock, [&] { return abandon || ending || !queue.empty(); });
      if (abandon || queue.empty()) return;
      const RgbdFrame frame = std::move(queue.front());
      queue.pop_front();
      std::string failure;
      lock.unlock();
      try {
        sink->write(frame);
      } catch (const std::exception& error) {
        failure = error.what();
        if (failure.empty()) failure = "unknown";
      }
      lock.lock();
      account(frame, failure, lock);
    }
  }

  void account(const RgbdFrame& frame, const std::string& failure, std::unique_lock<std::mutex>& lock) {
    std::string line;
    if (failure.empty()) {
      ++statistics.recorded;
      if (failures_in_a_row > 0) {
        line = fmt::format("writing works again; {} frames were lost", statistics.lost_failed);
      }
      failures_in_a_row = 0;
    } else {
      ++statistics.lost_failed;
      statistics.last_failure = failure;
      if (++failures_in_a_row == 1) line = fmt::format("frame {} is lost: {}", frame.sequence, failure);
      if (failures_in_a_row == options.failures_to_give_up) {
        line = fmt::format("{} frames in a row are lost: giving up", failures_in_a_row);
      }
    }
    if (line.empty()) return;
    lock.unlock();
    say(line);
    lock.lock();
  }
};

Recorder::Recorder(std::unique_ptr<FrameSink> sink, RecorderOptions options)
    : impl_(std::make_unique<Impl>()) {
  if (options.queue_frames < 1 || options.queue_frames > 1000) {
    throw UsageError("the recorder's queue must hold 1..1000 frames");
  }
  impl_->sink = std::move(sink);
  impl_->options = std::move(options);
  impl_->writer = std::thread([impl = impl_.get()] { impl->write_all(); });
}

Recorder::~Recorder() {
  {
    const std::lock_guard lock(impl_->mutex);
    impl_->abandon = true;
  }
  impl_->changed.notify_all();
  if (impl_->writer.joinable()) impl_->writer.join();
}

bool Recorder::offer(RgbdFrame frame) {
  std::string line;
  bool taken = true;
  {
    const std::lock_guard lock(impl_->mutex);
    ++impl_->statistics.offered;
    taken = impl_->queue.size() < static_cast<std::size_t>(impl_->options.queue_frames);
    if (taken) {
      if (impl_->losing && impl_->queue.empty()) {
        impl_->losing = false;
        line = fmt::format("the disk keeps up again; {} frames were lost", impl_->statistics.lost_slow);
      }
      impl_->queue.push_back(std::move(frame));
    } else {
      ++impl_->statistics.lost_slow;
      if (!impl_->losing) line = fmt::format("frame {} is lost: the disk does not keep up", frame.sequence);
      impl_->losing = true;
    }
  }
  impl_->changed.notify_all();
  if (!line.empty()) impl_->say(line);
  return taken;
}

bool Recorder::given_up() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->failures_in_a_row >= impl_->options.failures_to_give_up;
}

RecorderStatistics Recorder::statistics() const {
  const std::lock_guard lock(impl_->mutex);
  RecorderStatistics copy = impl_->statistics;
  copy.waiting = static_cast<int>(impl_->queue.size());
  return copy;
}

RecorderStatistics Recorder::finish(std::uint64_t lost_source) {
  {
    const std::lock_guard lock(impl_->mutex);
    impl_->ending = true;
  }
  impl_->changed.notify_all();
  if (impl_->writer.joinable()) impl_->writer.join();
  const RecorderStatistics s = statistics();
  impl_->sink->finish({s.recorded, s.lost_slow, s.lost_failed, lost_source});
  return s;
}

}  // namespace sextant
