// SPDX-License-Identifier: Apache-2.0
// The engine against brute force and against its plain twin: the same poses and scores, bit for bit.
#include "runtime/search/lanes/lane_search.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "../small_space.h"
#include "runtime/search/evaluate.h"
#include "runtime/search/reference/brute_force.h"

namespace sextant {
namespace {

/// A target with its prepared bins.
struct Prepared {
  std::vector<LaneBin> lane_bins;
  LaneTarget target;

  Prepared(const std::vector<ScoredBin>& bins, const Constraint& constraint, int wanted, double threshold)
      : lane_bins(prepare(bins, threshold)), target{bins, lane_bins, constraint, 0.1, wanted, threshold} {}
  static std::vector<LaneBin> prepare(const std::vector<ScoredBin>& bins, double threshold) {
    std::vector<LaneBin> out;
    for (const ScoredBin& bin : bins) out.push_back(lane_bin(bin, threshold));
    return out;
  }
};

/// A threshold between a perfect score and the plateau of poses at which nothing fits.
double middling(const std::vector<ScoredBin>& bins) { return 0.65 * bins[0].worst + 0.35 * bins[0].offset; }

SearchOutcome run(const FrameTables& exact, const Prepared& prepared, WorkerPool& pool,
                  std::function<bool()> expired = {}, std::size_t most_waiting = 200000) {
  LaneTables lanes;
  lanes.build(exact, pool);
  LaneSearch engine;
  return engine.run({exact, lanes, {prepared.target}, std::move(expired), most_waiting}, pool)[0];
}

void expect_same(const SearchOutcome& a, const SearchOutcome& b, std::uint64_t seed) {
  ASSERT_EQ(a.found.size(), b.found.size()) << "seed " << seed;
  for (std::size_t i = 0; i < a.found.size(); ++i) {
    EXPECT_EQ(a.found[i].pose, b.found[i].pose) << "seed " << seed;
    EXPECT_EQ(a.found[i].score, b.found[i].score) << "seed " << seed;
  }
}

TEST(LaneSearch, FindsWhatBruteForceFinds) {
  WorkerPool serial(1);
  int with_detections = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const SmallSpace s(seed, 16 + static_cast<int>(seed % 5), 12, 0.9, 0.915);
    for (const int wanted : {1, 3}) {
      SearchOptions options;
      options.max_detections = wanted;
      // Above some scores and below others.
      options.threshold = seed % 2 ? -1e6 : -200;
      const SearchOutcome truth = brute_force(s.search(), s.space, options);
      const Prepared prepared(s.bins, s.constraint, wanted, options.threshold);
      const SearchOutcome found = run(s.problem.tables(), prepared, serial);
      EXPECT_TRUE(found.complete);
      expect_same(found, truth, seed);
      EXPECT_GE(found.upper_bound, truth.upper_bound);
      if (!found.found.empty()) {
        EXPECT_LE(found.upper_bound, found.found.back().score);
        ++with_detections;
      } else {
        EXPECT_EQ(found.upper_bound, options.threshold);
      }
    }
  }
  EXPECT_GT(with_detections, 60);
}

TEST(LaneSearch, AgreesWithThePlainTwinOnWholeFrames) {
  WorkerPool serial(1);
  std::size_t found = 0;
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    RandomProblem p(seed, 72, 56);
    const Constraint constraint(p.camera(), 0.75, 0.9,
                                seed % 4 == 3 ? std::nullopt : std::optional<TableConstraint>(p.table()));
    SearchOptions options;
    options.max_detections = seed % 2 ? 1 : 3;
    options.threshold = middling(p.bins());
    const SearchOutcome plain = branch_and_bound({p.bins(), p.tables(), constraint, 0.1}, options, serial);
    const Prepared prepared(p.bins(), constraint, options.max_detections, options.threshold);
    expect_same(run(p.tables(), prepared, serial), plain, seed);
    found += plain.found.size();
  }
  EXPECT_GE(found, 3U);
}

TEST(LaneSearch, ProvesAbsenceAboveTheThreshold) {
  WorkerPool serial(1);
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const SmallSpace s(seed);
    SearchOptions options;
    options.threshold = -1e6;
    const SearchOutcome truth = brute_force(s.search(), s.space, options);
    if (truth.found.empty()) continue;
    const double best = truth.found[0].score;
    EXPECT_EQ(run(s.problem.tables(), Prepared(s.bins, s.constraint, 1, best), serial).found.size(), 1U);
    const double above = std::nextafter(best, 1e9);
    const SearchOutcome none = run(s.problem.tables(), Prepared(s.bins, s.constraint, 1, above), serial);
    EXPECT_TRUE(none.complete);
    EXPECT_TRUE(none.found.empty());
    EXPECT_EQ(none.upper_bound, above);
  }
}

TEST(LaneSearch, AnyNumberOfThreadsGivesTheSameBits) {
  for (const std::uint64_t seed : {0U, 3U}) {
    RandomProblem p(seed, 72, 56);
    const Constraint constraint(p.camera(), 0.6, 1.2, p.table());
    const Prepared prepared(p.bins(), constraint, 2, middling(p.bins()));
    WorkerPool serial(1);
    const SearchOutcome truth = run(p.tables(), prepared, serial);
    for (const int threads : {2, 3, 8}) {
      WorkerPool pool(threads);
      for (int repeat = 0; repeat < 4; ++repeat) {
        const SearchOutcome found = run(p.tables(), prepared, pool);
        expect_same(found, truth, seed);
        EXPECT_EQ(found.upper_bound, truth.upper_bound);
        EXPECT_EQ(found.complete, truth.complete);
      }
    }
  }
}

TEST(LaneSearch, AnInterruptedSearchStillTellsTheTruth) {
  WorkerPool serial(1);
  int interrupted = 0;
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const SmallSpace s(seed);
    SearchOptions options;
    options.threshold = -1e6;
    const SearchOutcome truth = brute_force(s.search(), s.space, options);
    if (truth.found.empty()) continue;
    const Prepared prepared(s.bins, s.constraint, 1, options.threshold);
    for (const int looks : {0, 1, 5, 20}) {
      int left = looks;
      const SearchOutcome found = run(s.problem.tables(), prepared, serial, [&left] { return left-- <= 0; });
      interrupted += found.complete ? 0 : 1;
      const double best = found.found.empty() ? -1e9 : found.found[0].score;
      EXPECT_GE(std::max(best, found.upper_bound), truth.found[0].score);
      EXPECT_LE(best, truth.found[0].score);
      if (!found.found.empty()) {
        const LatticePose& pose = found.found[0].pose;
        EXPECT_EQ(best, evaluate(s.bins[static_cast<std::size_t>(pose.bin)], s.problem.tables(), pose));
      }
    }
  }
  EXPECT_GT(interrupted, 5);
}

TEST(LaneSearch, AFullFrontierOnlyChangesTheOrder) {
  WorkerPool serial(1);
  for (const std::uint64_t seed : {0U, 3U, 4U}) {
    RandomProblem p(seed, 72, 56);
    const Constraint constraint(p.camera(), 0.6, 1.2, p.table());
    const Prepared prepared(p.bins(), constraint, 2, middling(p.bins()));
    const SearchOutcome free = run(p.tables(), prepared, serial);
    const SearchOutcome capped = run(p.tables(), prepared, serial, {}, 4);
    expect_same(capped, free, seed);
    EXPECT_TRUE(capped.complete);
  }
}

TEST(LaneSearch, SeveralObjectsTogetherAreFoundAsAlone) {
  WorkerPool pool(2);
  for (const std::uint64_t seed : {0U, 3U, 4U}) {
    RandomProblem p(seed, 72, 56);
    RandomProblem other(seed + 100, 72, 56);
    const Constraint constraint(p.camera(), 0.6, 1.2, p.table());
    const Constraint its(p.camera(), 0.7, 1.1, p.table());
    const Prepared a(p.bins(), constraint, 2, middling(p.bins()));
    const Prepared b(other.bins(), its, 1, middling(other.bins()));
    LaneTables lanes;
    lanes.build(p.tables(), pool);
    LaneSearch engine;
    const auto both = engine.run({p.tables(), lanes, {a.target, b.target}, {}}, pool);
    expect_same(both[0], engine.run({p.tables(), lanes, {a.target}, {}}, pool)[0], seed);
    expect_same(both[1], engine.run({p.tables(), lanes, {b.target}, {}}, pool)[0], seed);
  }
}

}  // namespace
}  // namespace sextant
