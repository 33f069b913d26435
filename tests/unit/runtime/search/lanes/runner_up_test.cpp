// SPDX-License-Identifier: Apache-2.0
// Runner-ups of the engine and of its plain twin against brute force.
#include "runtime/search/runner_up.h"

#include <gtest/gtest.h>

#include <cmath>

#include "../small_space.h"
#include "prepared_target.h"
#include "runtime/search/evaluate.h"
#include "runtime/search/reference/brute_force.h"

namespace sextant {
namespace {

/// The definition, pose by pose.
std::vector<RunnerUp> by_hand(const SmallSpace& s, const std::vector<ScoredPose>& found, double threshold,
                              const RunnerUpOptions& options) {
  const double focal = s.problem.camera().focal;
  Exclusion excluded;
  for (const ScoredPose& f : found) excluded.balls.emplace_back(s.problem.camera(), f.pose, options.ball);
  std::vector<RunnerUp> out;
  for (const ScoredPose& f : found) {
    RunnerUp best{std::max(threshold, f.score - options.most), false};
    for (const Region& region : s.space) {
      const ScoredBin& bin = s.bins[static_cast<std::size_t>(region.bin)];
      for_each_pose(region, [&](const LatticePose& pose) {
        if (!s.constraint.contains(pose) || excluded.contains(bin, focal, pose)) return;
        const double score = evaluate(bin, s.problem.tables(), pose);
        if (score >= best.score) best = {score, true};
      });
    }
    out.push_back(best);
    excluded.boxes.push_back(box_of(s.bins[static_cast<std::size_t>(f.pose.bin)], focal, f.pose));
  }
  return out;
}

void expect_same(const std::vector<RunnerUp>& a, const std::vector<RunnerUp>& b, std::uint64_t seed) {
  ASSERT_EQ(a.size(), b.size()) << "seed " << seed;
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].score, b[i].score) << "seed " << seed << " detection " << i;
    EXPECT_EQ(a[i].exact, b[i].exact) << "seed " << seed << " detection " << i;
  }
}

TEST(RunnerUp, IsWhatBruteForceFinds) {
  WorkerPool serial(1);
  WorkerPool three(3);
  int exact = 0, bounds = 0, second = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const SmallSpace s(seed, 16 + static_cast<int>(seed % 5), 12, 0.9, 0.915);
    RunnerUpOptions options;
    options.ball = {seed % 2 ? 0.02 : 0.05, static_cast<double>(seed % 3 + 1) * kOneDegree,
                    seed % 4 ? 360 : 0};
    if (seed % 5 == 4) options.most = 3;
    SearchOptions search;
    search.max_detections = seed % 3 ? 1 : 3;
    search.threshold = seed % 2 ? -1e6 : -200;
    const SearchOutcome truth = brute_force(s.search(), s.space, search);
    const auto wanted = by_hand(s, truth.found, search.threshold, options);
    expect_same(plain_runner_ups(s.search(), truth.found, search, options, serial), wanted, seed);
    PreparedTarget prepared(s.bins, s.constraint, search.max_detections, search.threshold);
    prepared.target.runner_up = options;
    for (WorkerPool* pool : {&serial, &three}) {
      const SearchOutcome outcome = run_lanes(s.problem.tables(), prepared, *pool);
      ASSERT_EQ(outcome.found.size(), truth.found.size()) << "seed " << seed;
      for (std::size_t i = 0; i < truth.found.size(); ++i) {
        EXPECT_EQ(outcome.found[i].pose, truth.found[i].pose);
        EXPECT_EQ(outcome.found[i].score, truth.found[i].score);
      }
      EXPECT_TRUE(outcome.complete);
      expect_same(outcome.runner_ups, wanted, seed);
    }
    for (const RunnerUp& r : wanted) ++(r.exact ? exact : bounds);
    second += wanted.size() > 1 ? 1 : 0;
  }
  EXPECT_GT(exact, 20);
  EXPECT_GT(bounds, 2);
  EXPECT_GT(second, 3);
}

TEST(RunnerUp, OutOfTimeItIsABound) {
  WorkerPool serial(1);
  int bounded = 0, known = 0;
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    const SmallSpace s(seed, 16, 12, 0.9, 0.915);
    RunnerUpOptions options;
    options.ball = {0.02, 2 * kOneDegree, 360};
    SearchOptions search;
    search.threshold = -1e6;
    search.max_detections = 2;
    const SearchOutcome truth = brute_force(s.search(), s.space, search);
    const auto wanted = by_hand(s, truth.found, search.threshold, options);
    PreparedTarget prepared(s.bins, s.constraint, 2, search.threshold);
    prepared.target.runner_up = options;
    for (int looks = 1; looks < 100000; looks *= 3) {
      int left = looks;
      const SearchOutcome outcome =
          run_lanes(s.problem.tables(), prepared, serial, [&left] { return left-- <= 0; });
      if (!outcome.complete) {
        EXPECT_TRUE(outcome.runner_ups.empty());
        continue;
      }
      ASSERT_EQ(outcome.runner_ups.size(), wanted.size());
      for (std::size_t i = 0; i < wanted.size(); ++i) {
        EXPECT_GE(outcome.runner_ups[i].score, wanted[i].score);
        if (outcome.runner_ups[i].exact) {
          EXPECT_EQ(outcome.runner_ups[i].score, wanted[i].score);
        }
        ++(outcome.runner_ups[i].exact ? known : bounded);
      }
    }
  }
  EXPECT_GT(bounded, 0);
  EXPECT_GT(known, 0);
}

}  // namespace
}  // namespace sextant
