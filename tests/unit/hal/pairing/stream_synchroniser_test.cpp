// SPDX-License-Identifier: Apache-2.0
#include "hal/pairing/stream_synchroniser.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace sextant {
namespace {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;
using Synchroniser = StreamSynchroniser<int>;

struct Event {
  Stream stream;
  milliseconds time;
  int id;
};

/// Pushes in the order given; returns the pairs (colour id, depth id), each with the event that released it.
struct Outcome {
  std::vector<std::pair<int, int>> pairs;
  std::vector<std::size_t> released_by;
  SynchroniserStatistics statistics;
};

Outcome run(const std::vector<Event>& events, SynchroniserOptions options = {}) {
  Synchroniser s(options);
  Outcome out;
  for (std::size_t i = 0; i < events.size(); ++i) {
    s.push(events[i].stream, events[i].time, events[i].id, events[i].id);
    while (const auto pair = s.pop()) {
      out.pairs.emplace_back(pair->colour, pair->depth);
      out.released_by.push_back(i);
    }
  }
  while (const auto pair = s.pop(true)) {
    out.pairs.emplace_back(pair->colour, pair->depth);
    out.released_by.push_back(events.size());
  }
  out.statistics = s.statistics();
  return out;
}

constexpr Stream kC = Stream::kColour;
constexpr Stream kD = Stream::kDepth;

TEST(StreamSynchroniser, PairsAtOnceWhenThePeriodIsKnown) {
  std::vector<Event> events;
  for (int i = 0; i < 10; ++i) {
    events.push_back({kC, milliseconds(33 * i), i});
    events.push_back({kD, milliseconds(33 * i + 6), i});
  }
  const Outcome r = run(events);
  ASSERT_EQ(r.pairs.size(), 10U);
  for (int i = 0; i < 10; ++i) EXPECT_EQ(r.pairs[static_cast<std::size_t>(i)], (std::pair{i, i}));
  // From the second pair on, the depth image itself releases the pair: no latency.
  for (std::size_t i = 2; i < 10; ++i) EXPECT_EQ(r.released_by[i], 2 * i + 1);
  EXPECT_EQ(r.statistics.unpaired[0] + r.statistics.unpaired[1], 0U);
}

TEST(StreamSynchroniser, TheNearerColourGetsTheDepth) {
  // Depth 20 is within the tolerance of colour 0, but colour 33 is nearer.
  SynchroniserOptions options;
  options.tolerance = milliseconds(25);
  const Outcome r =
      run({{kC, milliseconds(0), 0}, {kD, milliseconds(20), 7}, {kC, milliseconds(33), 1}}, options);
  ASSERT_EQ(r.pairs.size(), 1U);
  EXPECT_EQ(r.pairs[0], (std::pair{1, 7}));
  EXPECT_EQ(r.statistics.unpaired[0], 1U);
}

TEST(StreamSynchroniser, CountsWhatHasNoPartner) {
  std::vector<Event> events;
  for (int i = 0; i < 30; ++i) {
    events.push_back({kC, milliseconds(33 * i), i});
    if (i % 3 == 0) events.push_back({kD, milliseconds(33 * i + 2), i});  // a slower depth camera
  }
  const Outcome r = run(events);
  ASSERT_EQ(r.pairs.size(), 10U);
  for (const auto& [colour, depth] : r.pairs) EXPECT_EQ(colour, depth);
  EXPECT_GE(r.statistics.unpaired[0], 17U);  // those after the last depth still wait
  EXPECT_EQ(r.statistics.unpaired[1], 0U);
}

TEST(StreamSynchroniser, NothingWaitsWithoutBound) {
  Synchroniser s;
  for (int i = 0; i < 1000; ++i) s.push(kC, milliseconds(33 * i), i, i);
  EXPECT_EQ(s.statistics().unpaired[0], 992U);
  EXPECT_FALSE(s.pop());
}

TEST(StreamSynchroniser, SharedNumbersDecideWhateverTheClocksSay) {
  SynchroniserOptions options;
  options.shared_sequence = true;
  const Outcome r = run({{kC, milliseconds(0), 5},
                         {kD, milliseconds(900), 4},
                         {kD, milliseconds(950), 5},
                         {kC, milliseconds(66), 7},
                         {kD, milliseconds(960), 6},
                         {kD, milliseconds(970), 7}},
                        options);
  ASSERT_EQ(r.pairs.size(), 2U);
  EXPECT_EQ(r.pairs[0], (std::pair{5, 5}));
  EXPECT_EQ(r.pairs[1], (std::pair{7, 7}));
  EXPECT_EQ(r.statistics.unpaired[1], 2U);
}

TEST(StreamSynchroniser, AClockThatIsSetBackIsSurvived) {
  std::vector<Event> events;
  for (int i = 0; i < 5; ++i) {
    events.push_back({kC, milliseconds(100000 + 33 * i), i});
    events.push_back({kD, milliseconds(100000 + 33 * i + 1), i});
  }
  for (int i = 5; i < 10; ++i) {
    events.push_back({kC, milliseconds(33 * i), i});
    events.push_back({kD, milliseconds(33 * i + 1), i});
  }
  const Outcome r = run(events);
  ASSERT_EQ(r.pairs.size(), 10U);
  for (const auto& [colour, depth] : r.pairs) EXPECT_EQ(colour, depth);
  EXPECT_EQ(r.statistics.clock_jumps, 2U);
}

TEST(StreamSynchroniser, OneWildStampCostsOneFrame) {
  std::vector<Event> events;
  for (int i = 0; i < 20; ++i) {
    events.push_back({kC, milliseconds(i == 8 ? 10'000'000 : 33 * i), i});
    events.push_back({kD, milliseconds(33 * i + 1), i});
  }
  const Outcome r = run(events);
  EXPECT_EQ(r.pairs.size(), 19U);
  for (const auto& [colour, depth] : r.pairs) EXPECT_EQ(colour, depth);
}

TEST(StreamSynchroniser, TheSameFrameTwiceIsOne) {
  const Outcome r = run({{kC, milliseconds(0), 0}, {kC, milliseconds(0), 0}, {kD, milliseconds(0), 0}});
  EXPECT_EQ(r.pairs.size(), 1U);
  EXPECT_EQ(r.statistics.unpaired[0], 1U);
}

// Against brute force: with jitter below half a period and drops, the pairs are exactly the mutually nearest
// ones within the tolerance.
TEST(StreamSynchroniser, PairsAreTheMutuallyNearest) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    std::mt19937 random(seed);
    const auto jitter = [&] { return static_cast<int>(random() % 7); };
    const int offset = static_cast<int>(random() % 30);
    std::vector<Event> events;
    for (int i = 0; i < 40; ++i) {
      if (random() % 6 != 0) events.push_back({kC, milliseconds(33 * i + jitter()), i});
      if (random() % 6 != 0) events.push_back({kD, milliseconds(33 * i + offset + jitter()), i});
    }
    std::stable_sort(events.begin(), events.end(),
                     [](const auto& a, const auto& b) { return a.time < b.time; });
    SynchroniserOptions options;
    options.tolerance = milliseconds(12);
    const Outcome r = run(events, options);
    // Brute force.
    std::vector<std::pair<int, int>> expected;
    const auto nearest = [&](const Event& of) {
      const Event* best = nullptr;
      for (const Event& e : events) {
        if (e.stream == of.stream) continue;
        if (!best || std::abs((e.time - of.time).count()) < std::abs((best->time - of.time).count()))
          best = &e;
      }
      return best;
    };
    std::size_t ties = 0;
    for (const Event& e : events) {
      if (e.stream != kC) continue;
      const Event* depth = nearest(e);
      if (!depth || std::abs((depth->time - e.time).count()) > 12) continue;
      if (nearest(*depth) == &e) {
        expected.emplace_back(e.id, depth->id);
      } else {
        ++ties;
      }
    }
    // The early decision trusts the period: a jittering stream may break a near tie the other way.
    std::size_t same = 0;
    for (const auto& pair : r.pairs) {
      same += std::find(expected.begin(), expected.end(), pair) != expected.end() ? 1U : 0U;
    }
    EXPECT_GE(same + 1 + ties, r.pairs.size()) << seed;
    EXPECT_GE(r.pairs.size() + 1, expected.size()) << seed;
  }
}

}  // namespace
}  // namespace sextant
