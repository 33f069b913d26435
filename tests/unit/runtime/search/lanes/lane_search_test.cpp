// SPDX-License-Identifier: Apache-2.0
// The engine against brute force and against its plain twin: the same poses and scores, bit for bit.
#include "runtime/search/lanes/lane_search.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "../small_space.h"
#include "prepared_target.h"
#include "runtime/search/evaluate.h"
#include "runtime/search/reference/brute_force.h"

namespace sextant {
namespace {

/// A threshold between a perfect score and the plateau of poses at which nothing fits.
double middling(const std::vector<ScoredBin>& bins) { return 0.65 * bins[0].worst + 0.35 * bins[0].offset; }

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
      const PreparedTarget prepared(s.bins, s.constraint, wanted, options.threshold);
      const SearchOutcome found = run_lanes(s.problem.tables(), prepared, serial);
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

TEST(LaneSearch, FindsTheNextDetectionBesideWhatAnEarlierSearchTook) {
  WorkerPool serial(1);
  WorkerPool three(3);
  int next = 0, none = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const SmallSpace s(seed, 16 + static_cast<int>(seed % 5), 12, 0.9, 0.915);
    SearchOptions options;
    options.max_detections = 2;
    options.threshold = seed % 2 ? -1e6 : -200;
    const SearchOutcome truth = brute_force(s.search(), s.space, options);
    if (truth.found.empty()) continue;
    const LatticePose& first = truth.found[0].pose;
    const Box2 taken = box_of(s.bins[static_cast<std::size_t>(first.bin)], s.problem.camera().focal, first);
    // In every third space nothing else is good enough.
    if (seed % 3 == 0) options.threshold = truth.found[0].score;
    const bool another = truth.found.size() > 1 && truth.found[1].score >= options.threshold;
    PreparedTarget prepared(s.bins, s.constraint, 1, options.threshold);
    prepared.target.taken = {taken};
    prepared.target.seeds = {first};  // suppressed: of no use
    options.max_detections = 1;
    options.excluded.boxes = {taken};
    const SearchOutcome plain = branch_and_bound(s.search(), options, serial);
    for (WorkerPool* pool : {&serial, &three}) {
      const SearchOutcome found = run_lanes(s.problem.tables(), prepared, *pool);
      EXPECT_TRUE(found.complete);
      expect_same(found, plain, seed);
      ASSERT_EQ(found.found.size(), another ? 1U : 0U) << "seed " << seed;
      if (!another) {
        EXPECT_EQ(found.upper_bound, options.threshold);
        continue;
      }
      EXPECT_EQ(found.found[0].pose, truth.found[1].pose) << "seed " << seed;
      EXPECT_EQ(found.found[0].score, truth.found[1].score) << "seed " << seed;
    }
    ++(another ? next : none);
  }
  EXPECT_GT(next, 10);
  EXPECT_GT(none, 2);
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
    const PreparedTarget prepared(p.bins(), constraint, options.max_detections, options.threshold);
    expect_same(run_lanes(p.tables(), prepared, serial), plain, seed);
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
    EXPECT_EQ(
        run_lanes(s.problem.tables(), PreparedTarget(s.bins, s.constraint, 1, best), serial).found.size(),
        1U);
    const double above = std::nextafter(best, 1e9);
    const SearchOutcome none =
        run_lanes(s.problem.tables(), PreparedTarget(s.bins, s.constraint, 1, above), serial);
    EXPECT_TRUE(none.complete);
    EXPECT_TRUE(none.found.empty());
    EXPECT_EQ(none.upper_bound, above);
  }
}

TEST(LaneSearch, AnyNumberOfThreadsGivesTheSameBits) {
  for (const std::uint64_t seed : {0U, 3U}) {
    RandomProblem p(seed, 72, 56);
    const Constraint constraint(p.camera(), 0.6, 1.2, p.table());
    const PreparedTarget prepared(p.bins(), constraint, 2, middling(p.bins()));
    WorkerPool serial(1);
    const SearchOutcome truth = run_lanes(p.tables(), prepared, serial);
    for (const int threads : {1, 2, 3, 8}) {
      WorkerPool pool(threads);
      for (int repeat = 0; repeat < 20; ++repeat) {
        const SearchOutcome found = run_lanes(p.tables(), prepared, pool);
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
    const PreparedTarget prepared(s.bins, s.constraint, 1, options.threshold);
    for (const int looks : {0, 1, 5, 20, 25, 30, 40, 60}) {
      int left = looks;
      const SearchOutcome found =
          run_lanes(s.problem.tables(), prepared, serial, [&left] { return left-- <= 0; });
      interrupted += found.complete ? 0 : 1;
      const double best = found.found.empty() ? -1e9 : found.found[0].score;
      EXPECT_GE(std::max(best, found.upper_bound), truth.found[0].score) << seed << " " << looks;
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
    const PreparedTarget prepared(p.bins(), constraint, 2, middling(p.bins()));
    const SearchOutcome free = run_lanes(p.tables(), prepared, serial);
    const SearchOutcome capped = run_lanes(p.tables(), prepared, serial, {}, 4);
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
    const PreparedTarget a(p.bins(), constraint, 2, middling(p.bins()));
    const PreparedTarget b(other.bins(), its, 1, middling(other.bins()));
    LaneTables lanes;
    lanes.build(p.tables(), pool);
    LaneSearch engine;
    const auto both = engine.run({p.tables(), lanes, {a.target, b.target}, {}}, pool);
    expect_same(both[0], engine.run({p.tables(), lanes, {a.target}, {}}, pool)[0], seed);
    expect_same(both[1], engine.run({p.tables(), lanes, {b.target}, {}}, pool)[0], seed);
  }
}

TEST(LaneSearch, SeedsNeverChangeTheAnswer) {
  WorkerPool serial(1);
  std::uint64_t nodes = 0, nodes_with_seeds = 0;
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    RandomProblem p(seed, 72, 56);
    const Constraint constraint(p.camera(), 0.7, 1.0, p.table());
    PreparedTarget prepared(p.bins(), constraint, seed % 3 ? 1 : 3, middling(p.bins()));
    if (seed % 2) prepared.target.runner_up = RunnerUpOptions{};
    const SearchOutcome plain = run_lanes(p.tables(), prepared, serial);
    nodes += plain.nodes;
    // Any poses: feasible or not, of bins that do not exist, the answer itself, one after another.
    for (int round = 0; round < 3; ++round) {
      for (int i = 0; i < 5; ++i) prepared.target.seeds.push_back(p.pose_in(p.region(20)));
      prepared.target.seeds.push_back({99, {1, 1, 400, 0, 0, 0}});
      prepared.target.seeds.push_back({-1, {1, 1, 400, 0, 0, 0}});
      prepared.target.seeds.push_back({0, {-5, 1, 400, 0, 0, 0}});
      if (round > 0) {
        for (const ScoredPose& f : plain.found) prepared.target.seeds.push_back(f.pose);
      }
      const SearchOutcome seeded = run_lanes(p.tables(), prepared, serial);
      expect_same(seeded, plain, seed);
      EXPECT_EQ(seeded.upper_bound, plain.upper_bound);
      ASSERT_EQ(seeded.runner_ups.size(), plain.runner_ups.size());
      for (std::size_t i = 0; i < plain.runner_ups.size(); ++i) {
        EXPECT_EQ(seeded.runner_ups[i].score, plain.runner_ups[i].score);
      }
      if (round == 2) nodes_with_seeds += seeded.nodes;
    }
  }
  EXPECT_LE(nodes_with_seeds, nodes);
}

TEST(LaneSearch, StopsAtTheDeadlineOfAnyClock) {
  WorkerPool serial(1);
  RandomProblem p(3, 72, 56);
  const Constraint constraint(p.camera(), 0.6, 1.2, p.table());
  const PreparedTarget prepared(p.bins(), constraint, 1, middling(p.bins()));
  const SearchOutcome whole = run_lanes(p.tables(), prepared, serial);
  ASSERT_GT(whole.nodes, 1000U);
  int stopped = 0;
  for (double deadline_ms = 0; deadline_ms < 40; deadline_ms += 2.5) {
    // A clock that advances by a quarter of a millisecond with every look.
    double now_ms = 0;
    int looks_too_late = 0;
    const SearchOutcome found = run_lanes(p.tables(), prepared, serial, [&] {
      now_ms += 0.25;
      looks_too_late += now_ms > deadline_ms ? 1 : 0;
      return now_ms > deadline_ms;
    });
    // It stops at the first look that says so: what it does between two looks is all that it is late.
    EXPECT_LE(looks_too_late, 1);
    stopped += found.complete ? 0 : 1;
    if (!found.complete) {
      EXPECT_LE(found.nodes, 64 + static_cast<std::uint64_t>(deadline_ms / 0.25 + 2) * 64 + 4096);
      const double best = found.found.empty() ? -1e9 : found.found[0].score;
      EXPECT_GE(std::max(best, found.upper_bound), whole.found.empty() ? -1e9 : whole.found[0].score);
    }
  }
  EXPECT_GT(stopped, 3);
}

// What offline/mpi does, in one process: shares, moved nodes, lost shares.
TEST(LaneSearch, InPiecesItIsTheSameSearch) {
  WorkerPool serial(1);
  for (const std::uint64_t seed : {0U, 3U, 4U, 5U}) {
    RandomProblem p(seed, 72, 56);
    const Constraint constraint(p.camera(), 0.6, 1.2, p.table());
    PreparedTarget prepared(p.bins(), constraint, 2, middling(p.bins()));
    prepared.target.runner_up = RunnerUpOptions{};
    const SearchOutcome whole = run_lanes(p.tables(), prepared, serial);
    LaneTables lanes;
    lanes.build(p.tables(), serial);
    const LaneSearchProblem problem{p.tables(), lanes, {prepared.target}, {}};
    for (const std::size_t count : {1U, 2U, 5U}) {
      std::vector<LaneSearch> ranks(count);
      for (std::size_t r = 0; r < count; ++r) ranks[r].begin(problem, {r, count});
      bool more = true;
      bool lost = false;
      while (more) {
        bool any = true;
        while (any) {
          any = false;
          for (std::size_t r = 0; r < ranks.size(); ++r) {
            any = any || ranks[r].waiting() > 0;
            ranks[r].step(7);
            const ScoredPose best = ranks[r].bests()[0];
            for (LaneSearch& other : ranks) {
              if (best.score > -1e300) other.offer(0, best);
            }
            if (ranks[r].waiting() > 20) ranks[(r + 1) % ranks.size()].take(ranks[r].give(9));
          }
          // One rank is lost with everything it has; its share, and all that was ever moved to it, is here
          // the whole space.
          if (!lost && ranks.size() == 5) {
            lost = true;
            ranks.pop_back();
            ranks[0].add_roots({0, 1});
            any = true;
          }
        }
        ScoredPose best = ranks[0].bests()[0];
        for (const LaneSearch& rank : ranks) {
          const ScoredPose its = rank.bests()[0];
          if (its.score > best.score || (its.score == best.score && its.pose < best.pose)) best = its;
        }
        bool first = true;
        for (LaneSearch& rank : ranks) {
          const bool its = rank.advance({best});
          EXPECT_TRUE(first || its == more);
          more = its;
          first = false;
        }
      }
      const SearchOutcome found = ranks[0].finish(true, {})[0];
      expect_same(found, whole, seed);
      EXPECT_TRUE(found.complete);
      EXPECT_EQ(found.upper_bound, whole.upper_bound);
      ASSERT_EQ(found.runner_ups.size(), whole.runner_ups.size());
      for (std::size_t i = 0; i < whole.runner_ups.size(); ++i) {
        EXPECT_EQ(found.runner_ups[i].score, whole.runner_ups[i].score) << "seed " << seed << " of " << count;
        EXPECT_EQ(found.runner_ups[i].exact, whole.runner_ups[i].exact);
      }
    }
  }
}

}  // namespace
}  // namespace sextant
