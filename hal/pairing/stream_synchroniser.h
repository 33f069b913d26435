// SPDX-License-Identifier: Apache-2.0
// Which colour image belongs to which depth image: the mutually nearest in time within a tolerance, or the
// same hardware sequence number. A pair is decided as soon as no image that may still come could be nearer.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <deque>
#include <optional>
#include <utility>

namespace sextant {

/// The two streams of a pair.
enum class Stream : std::uint8_t { kColour, kDepth };

struct SynchroniserOptions {
  std::chrono::nanoseconds tolerance = std::chrono::milliseconds(17);  ///< half a period at 30 Hz
  bool shared_sequence = false;  ///< both streams count the same frames: pair equal numbers, not times
  std::size_t waiting = 8;       ///< images of a stream that wait for a partner, at most (>= 2)
};

/// What had no partner, by stream.
struct SynchroniserStatistics {
  std::uint64_t pairs = 0;
  std::array<std::uint64_t, 2> unpaired{};
  std::uint64_t clock_jumps = 0;  ///< times that a stream's clock ran backwards
};

/// T is what an image is handed over as. Not thread-safe.
template <typename T>
class StreamSynchroniser {
 public:
  using Time = std::chrono::nanoseconds;  ///< of one clock for both streams
  struct Pair {
    T colour;
    T depth;
    Time colour_time;
    Time depth_time;
  };

  explicit StreamSynchroniser(SynchroniserOptions options = {}) : options_(options) {}

  /// Images of one stream come in the order of their times; an earlier time than the last one's is a clock
  /// that was set back: what waits of that stream is given up.
  void push(Stream stream, Time time, std::int64_t sequence, T image) {
    Queue& queue = queues_[index(stream)];
    if (queue.last && time <= *queue.last) {
      if (time == *queue.last && !options_.shared_sequence) {
        ++statistics_.unpaired[index(stream)];  // the same frame again
        return;
      }
      if (time < *queue.last) {
        ++statistics_.clock_jumps;
        while (!queue.items.empty()) give_up(stream);
        queue.intervals.clear();
      }
    } else if (queue.last) {
      queue.intervals.push_back(time - *queue.last);
      if (queue.intervals.size() > kIntervals) queue.intervals.pop_front();
    }
    queue.last = time;
    if (queue.items.size() >= options_.waiting) give_up(stream);
    queue.items.push_back({time, sequence, std::move(image)});
  }

  /// No image of the stream waits for a partner.
  bool idle(Stream stream) const { return queues_[index(stream)].items.empty(); }

  /// The oldest pair that is certain, or nothing. at_end: no image will come any more, decide now.
  std::optional<Pair> pop(bool at_end = false) {
    while (!queues_[0].items.empty() && !queues_[1].items.empty()) {
      const Decision decision = options_.shared_sequence ? by_sequence() : by_time(at_end);
      switch (decision) {
        case Decision::kWait:
          return std::nullopt;
        case Decision::kPair:
          return take();
        case Decision::kGiveUpColour:
          give_up(Stream::kColour);
          break;
        case Decision::kGiveUpDepth:
          give_up(Stream::kDepth);
          break;
      }
    }
    return std::nullopt;
  }

  const SynchroniserStatistics& statistics() const { return statistics_; }

 private:
  static constexpr std::size_t kIntervals = 8;
  enum class Decision : std::uint8_t { kWait, kPair, kGiveUpColour, kGiveUpDepth };
  struct Item {
    Time time;
    std::int64_t sequence;
    T image;
  };
  struct Queue {
    std::deque<Item> items;
    std::optional<Time> last;
    std::deque<Time> intervals;  ///< between the last images
  };

  static std::size_t index(Stream stream) { return static_cast<std::size_t>(stream); }

  Decision by_sequence() const {
    const std::int64_t colour = queues_[0].items.front().sequence;
    const std::int64_t depth = queues_[1].items.front().sequence;
    if (colour == depth) return Decision::kPair;
    return colour < depth ? Decision::kGiveUpColour : Decision::kGiveUpDepth;
  }

  Decision by_time(bool at_end) const {
    const Time lead = queues_[1].items.front().time - queues_[0].items.front().time;
    const bool colour_first = lead >= Time::zero();
    const Queue& early = queues_[colour_first ? 0 : 1];
    const Queue& late = queues_[colour_first ? 1 : 0];
    const Decision give_up_early = colour_first ? Decision::kGiveUpColour : Decision::kGiveUpDepth;
    const Time gap = colour_first ? lead : -lead;
    // Whatever else comes of the late stream is later still.
    if (gap > options_.tolerance) return give_up_early;
    if (early.items.size() >= 2) {
      const Time next = early.items[1].time - late.items.front().time;
      return (next < Time::zero() ? -next : next) < gap ? give_up_early : Decision::kPair;
    }
    // The next of the early stream is not here yet: could it be nearer?
    if (at_end || gap == Time::zero() || late.items.size() >= 2) return Decision::kPair;
    if (early.intervals.empty()) return Decision::kWait;
    const Time period = *std::min_element(early.intervals.begin(), early.intervals.end());
    return period >= 2 * gap ? Decision::kPair : Decision::kWait;
  }

  void give_up(Stream stream) {
    queues_[index(stream)].items.pop_front();
    ++statistics_.unpaired[index(stream)];
  }

  Pair take() {
    Item colour = std::move(queues_[0].items.front());
    Item depth = std::move(queues_[1].items.front());
    queues_[0].items.pop_front();
    queues_[1].items.pop_front();
    ++statistics_.pairs;
    return {std::move(colour.image), std::move(depth.image), colour.time, depth.time};
  }

  SynchroniserOptions options_;
  std::array<Queue, 2> queues_;
  SynchroniserStatistics statistics_;
};

}  // namespace sextant
