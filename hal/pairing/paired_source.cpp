// SPDX-License-Identifier: Apache-2.0
#include "hal/pairing/paired_source.h"

#include <array>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "runtime/base/error.h"

namespace sextant {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

/// How long a stream's thread waits in its source before it looks whether it should end.
constexpr milliseconds kSlice{50};

/// A decoded image with what identifies it.
struct Decoded {
  cv::Mat pixels;
  CaptureStamp captured;
  std::int64_t sequence = 0;
};

class PairedSource final : public FrameSource {
 public:
  PairedSource(std::unique_ptr<ImageSource> colour, std::unique_ptr<ImageSource> depth,
               PairedSourceOptions options)
      : options_(std::move(options)),
        streams_{std::move(colour), std::move(depth)},
        composer_(options_.calibration, options_.composer,
                  streams_[0]->name() + " and " + streams_[1]->name()),
        synchroniser_(options_.synchroniser) {
    for (const Stream stream : {Stream::kColour, Stream::kDepth}) {
      threads_[index(stream)] = std::thread([this, stream] { read(stream); });
    }
  }

  ~PairedSource() override {
    PairedSource::close();
    for (std::thread& thread : threads_) thread.join();
  }

  std::optional<RgbdFrame> next(milliseconds timeout) override {
    const Clock::time_point deadline = Clock::now() + timeout;
    for (;;) {
      std::optional<Pair> pair;
      {
        std::unique_lock lock(mutex_);
        changed_.wait_until(lock, deadline, [&] {
          take_newest(pair);
          return pair || closed_ || error_ || finished();
        });
        if (closed_) return std::nullopt;
        if (!pair && error_) std::rethrow_exception(error_);
        if (!pair) return std::nullopt;
        if (is_stale(pair->colour)) {
          ++statistics_.drop(DropReason::kStale);
          continue;
        }
        last_ = pair->colour.captured.monotonic;
      }
      // Registration takes milliseconds: not under the lock that the streams' threads need.
      RgbdFrame frame = composer_.compose(pair->colour.pixels, pair->depth.pixels);
      frame.captured_at = pair->colour.captured.realtime;
      frame.captured_monotonic = pair->colour.captured.monotonic;
      frame.sequence = pair->colour.sequence;
      frame.frame_id = options_.frame_id;
      const std::lock_guard lock(mutex_);
      if (closed_) return std::nullopt;
      ++statistics_.delivered;
      return frame;
    }
  }

  SourceState state() const override {
    {
      const std::lock_guard lock(mutex_);
      if (closed_ || finished()) return SourceState::kEnded;
    }
    for (const auto& stream : streams_) {
      if (stream->state() == SourceState::kWaiting) return SourceState::kWaiting;
    }
    return SourceState::kRunning;
  }

  std::string condition() const override {
    std::string text;
    const std::array<const char*, 2> names{"colour: ", "depth: "};
    for (std::size_t i = 0; i < 2; ++i) {
      const std::string of_stream = streams_[i]->condition();
      if (!of_stream.empty()) text += (text.empty() ? "" : "; ") + (names[i] + of_stream);
    }
    const std::lock_guard lock(mutex_);
    if (!refusal_.empty()) text += (text.empty() ? "" : "; ") + refusal_;
    return text;
  }

  SourceStatistics statistics() const override {
    SourceStatistics sum;
    {
      const std::lock_guard lock(mutex_);
      sum = statistics_;
      const SynchroniserStatistics& s = synchroniser_.statistics();
      sum.drop(DropReason::kUnpaired) += s.unpaired[0] + s.unpaired[1];
    }
    for (const auto& stream : streams_) {
      const SourceStatistics own = stream->statistics();
      sum.reconnects += own.reconnects;
      for (std::size_t i = 0; i < kDropReasons; ++i) sum.drops[i] += own.drops[i];
    }
    return sum;
  }

  void close() override {
    {
      const std::lock_guard lock(mutex_);
      closed_ = true;
    }
    changed_.notify_all();
    for (const auto& stream : streams_) stream->close();
  }

 private:
  using Synchroniser = StreamSynchroniser<Decoded>;
  using Pair = Synchroniser::Pair;

  static std::size_t index(Stream stream) { return static_cast<std::size_t>(stream); }
  bool any_ended() const { return ended_[0] || ended_[1]; }
  /// A stream has ended and none of its images waits: no pair can come any more.
  bool finished() const {
    return (ended_[0] && synchroniser_.idle(Stream::kColour)) ||
           (ended_[1] && synchroniser_.idle(Stream::kDepth));
  }

  /// One stream's thread.
  void read(Stream stream) {
    ImageSource& source = *streams_[index(stream)];
    while (!is_closed()) {
      try {
        const std::optional<RawImage> raw = source.next(kSlice);
        if (raw) {
          accept(stream, *raw);
        } else if (source.state() == SourceState::kEnded) {
          break;
        }
      } catch (const InputError& error) {
        count(DropReason::kDamaged, error.what());
      } catch (...) {
        const std::lock_guard lock(mutex_);
        if (!error_) error_ = std::current_exception();
        break;
      }
    }
    const std::lock_guard lock(mutex_);
    ended_[index(stream)] = true;
    changed_.notify_all();
  }

  void accept(Stream stream, const RawImage& raw) {
    const RgbdCalibration& calibration = options_.calibration;
    const bool colour = stream == Stream::kColour;
    const CameraModel& camera =
        colour || calibration.depth_is_registered ? calibration.colour : calibration.depth;
    if (raw.width != camera.width || raw.height != camera.height) {
      count(DropReason::kRefused, std::string(colour ? "colour" : "depth") + " images are " +
                                      std::to_string(raw.width) + " x " + std::to_string(raw.height) +
                                      ", the calibration is for " + std::to_string(camera.width) + " x " +
                                      std::to_string(camera.height));
      return;
    }
    const std::string where = streams_[index(stream)]->name();
    Decoded decoded{colour ? decode_colour(raw, where) : decode_depth(raw, options_.depth_scale, where),
                    raw.captured, raw.sequence};
    const std::lock_guard lock(mutex_);
    const auto time = std::chrono::nanoseconds(raw.captured.monotonic.time_since_epoch());
    synchroniser_.push(stream, time, raw.sequence, std::move(decoded));
    changed_.notify_all();
  }

  /// The newest pair that is certain; the ones before it are superseded.
  void take_newest(std::optional<Pair>& newest) {
    while (auto pair = synchroniser_.pop(any_ended())) {
      if (newest) ++statistics_.drop(DropReason::kSuperseded);
      newest = std::move(pair);
    }
    if (newest && last_ && newest->colour.captured.monotonic <= *last_) {
      ++statistics_.drop(DropReason::kBadTime);
      newest.reset();
      last_.reset();  // the device's clock was set back: its time counts from here
    }
  }

  bool is_stale(const Decoded& colour) const {
    return options_.max_age.count() > 0 && options_.now() - colour.captured.monotonic > options_.max_age;
  }

  bool is_closed() const {
    const std::lock_guard lock(mutex_);
    return closed_;
  }

  void count(DropReason reason, const std::string& why) {
    const std::lock_guard lock(mutex_);
    ++statistics_.drop(reason);
    refusal_ = why;
  }

  const PairedSourceOptions options_;
  const std::array<std::unique_ptr<ImageSource>, 2> streams_;
  FrameComposer composer_;  // of the thread that calls next()

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  Synchroniser synchroniser_;
  SourceStatistics statistics_;
  std::array<bool, 2> ended_{};
  bool closed_ = false;
  std::exception_ptr error_;
  std::string refusal_;                ///< the last image that was refused, and why
  std::optional<MonotonicTime> last_;  ///< of the frame handed out last

  std::array<std::thread, 2> threads_;  // last: they use all of the above
};

}  // namespace

std::unique_ptr<FrameSource> pair_streams(std::unique_ptr<ImageSource> colour,
                                          std::unique_ptr<ImageSource> depth, PairedSourceOptions options) {
  return std::make_unique<PairedSource>(std::move(colour), std::move(depth), std::move(options));
}

}  // namespace sextant
