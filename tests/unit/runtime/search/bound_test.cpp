// SPDX-License-Identifier: Apache-2.0
// Every bound against exhaustive evaluation: thousands of random regions of random frames and models.
#include "runtime/search/bound.h"

#include <gtest/gtest.h>

#include <limits>

#include "random_problem.h"
#include "runtime/search/evaluate.h"
#include "runtime/search/reference/brute_force.h"
#include "runtime/search/reference/thesis_bound.h"

namespace sextant {
namespace {

constexpr double kNoFloor = -std::numeric_limits<double>::infinity();

double best_in(const RandomProblem& p, const Region& r) {
  double best = kNoFloor;
  for_each_pose(r, [&](const LatticePose& pose) {
    best = std::max(best, evaluate(p.bins()[static_cast<std::size_t>(r.bin)], p.tables(), pose));
  });
  return best;
}

TEST(Bound, IsNeverBelowAnyPoseOfSmallRegions) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    RandomProblem p(seed);
    const ThesisTables thesis(p.tables());
    for (int i = 0; i < 60; ++i) {
      const Region r = p.region(i % 3);
      const double best = best_in(p, r);
      const ScoredBin& bin = p.bins()[static_cast<std::size_t>(r.bin)];
      ASSERT_GE(window_bound(bin, p.tables(), r, kNoFloor), best);
      ASSERT_GE(thesis_bound(bin, thesis, r), best);
    }
  }
}

TEST(Bound, IsNeverBelowSampledPosesOfLargeRegions) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    RandomProblem p(seed);
    const ThesisTables thesis(p.tables());
    for (int i = 0; i < 150; ++i) {
      const Region r = p.region(1 << (i % 8));
      const ScoredBin& bin = p.bins()[static_cast<std::size_t>(r.bin)];
      const double window = window_bound(bin, p.tables(), r, kNoFloor);
      const double sat = thesis_bound(bin, thesis, r);
      for (int k = 0; k < 100; ++k) {
        const double score = evaluate(bin, p.tables(), p.pose_in(r));
        ASSERT_GE(window, score);
        ASSERT_GE(sat, score);
      }
    }
  }
}

TEST(Bound, IsExactForASinglePose) {
  RandomProblem p(5);
  for (int i = 0; i < 500; ++i) {
    const Region r = p.region(0);
    const ScoredBin& bin = p.bins()[static_cast<std::size_t>(r.bin)];
    EXPECT_EQ(window_bound(bin, p.tables(), r, kNoFloor), evaluate(bin, p.tables(), r.first()));
  }
}

TEST(Bound, StopsEarlyOnlyBelowTheFloor) {
  RandomProblem p(6);
  for (int i = 0; i < 500; ++i) {
    const Region r = p.region(6);
    const ScoredBin& bin = p.bins()[static_cast<std::size_t>(r.bin)];
    const double full = window_bound(bin, p.tables(), r, kNoFloor);
    for (const double floor : {full - 1, full, full + 1e-9, full + 5}) {
      const double early = window_bound(bin, p.tables(), r, floor);
      if (floor <= full) {
        EXPECT_EQ(early, full);
      } else {
        EXPECT_LT(early, floor);
      }
    }
  }
}

TEST(Bound, WindowsAreTighterThanTheThesisOnAverage) {
  RandomProblem p(7);
  const ThesisTables thesis(p.tables());
  double window = 0;
  double sat = 0;
  for (int i = 0; i < 300; ++i) {
    const Region r = p.region(8);
    window += window_bound(p.bins()[static_cast<std::size_t>(r.bin)], p.tables(), r, kNoFloor);
    sat += thesis_bound(p.bins()[static_cast<std::size_t>(r.bin)], thesis, r);
  }
  EXPECT_LT(window, sat);
}

}  // namespace
}  // namespace sextant
