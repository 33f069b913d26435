// SPDX-License-Identifier: Apache-2.0
// The search against brute force: the same poses in the same order, the same scores, bit for bit.
#include "runtime/search/branch_and_bound.h"

#include <gtest/gtest.h>

#include <limits>

#include "runtime/search/evaluate.h"
#include "runtime/search/reference/brute_force.h"
#include "runtime/search/reference/thesis_search.h"
#include "small_space.h"

namespace sextant {
namespace {

void expect_same(const SearchOutcome& a, const SearchOutcome& b) {
  ASSERT_EQ(a.found.size(), b.found.size());
  for (std::size_t i = 0; i < a.found.size(); ++i) {
    EXPECT_EQ(a.found[i].pose, b.found[i].pose);
    EXPECT_EQ(a.found[i].score, b.found[i].score);
  }
}

TEST(BranchAndBound, FindsWhatBruteForceFinds) {
  WorkerPool serial(1);
  int with_detections = 0;
  for (std::uint64_t seed = 0; seed < 24; ++seed) {
    const SmallSpace s(seed);
    for (const int wanted : {1, 3}) {
      SearchOptions options;
      options.max_detections = wanted;
      options.threshold = -1e6;
      const SearchOutcome truth = brute_force(s.search(), s.space, options);
      const SearchOutcome found = branch_and_bound(s.search(), options, serial);
      EXPECT_TRUE(found.complete);
      expect_same(found, truth);
      EXPECT_GE(found.upper_bound, truth.upper_bound);
      if (!found.found.empty()) {
        EXPECT_LE(found.upper_bound, found.found.back().score);
        ++with_detections;
      }
    }
  }
  EXPECT_GT(with_detections, 20);
}

TEST(BranchAndBound, ProvesAbsenceAboveTheThreshold) {
  WorkerPool serial(1);
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const SmallSpace s(seed);
    SearchOptions options;
    options.threshold = -1e6;
    const SearchOutcome truth = brute_force(s.search(), s.space, options);
    if (truth.found.empty()) continue;
    options.threshold = truth.found[0].score;  // reached: equality counts
    EXPECT_EQ(branch_and_bound(s.search(), options, serial).found.size(), 1U);
    options.threshold = std::nextafter(truth.found[0].score, 1e9);
    const SearchOutcome none = branch_and_bound(s.search(), options, serial);
    EXPECT_TRUE(none.complete);
    EXPECT_TRUE(none.found.empty());
    EXPECT_EQ(none.upper_bound, options.threshold);
  }
}

TEST(BranchAndBound, TheThesisSearchAgrees) {
  WorkerPool serial(1);
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    const SmallSpace s(seed);
    SearchOptions options;
    options.threshold = -1e6;
    const SearchOutcome ours = branch_and_bound(s.search(), options, serial);
    const SearchOutcome thesis = thesis_search(s.search(), options);
    ASSERT_EQ(ours.found.size(), thesis.found.size());
    // The thesis keeps one pose per minimum region, so only the score is bound to agree where poses tie.
    if (!ours.found.empty()) {
      EXPECT_EQ(ours.found[0].score, thesis.found[0].score);
    }
  }
}

TEST(BranchAndBound, AnyNumberOfThreadsGivesTheSameBits) {
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    RandomProblem p(seed);
    const Constraint constraint(p.camera(), 0.6, 1.2, p.table());
    SearchOptions options;
    options.max_detections = 2;
    options.threshold = -1e6;
    WorkerPool serial(1);
    const SearchOutcome truth = branch_and_bound({p.bins(), p.tables(), constraint, 0.1}, options, serial);
    for (const int threads : {2, 3, 8}) {
      WorkerPool pool(threads);
      for (int repeat = 0; repeat < 3; ++repeat) {
        const SearchOutcome found = branch_and_bound({p.bins(), p.tables(), constraint, 0.1}, options, pool);
        expect_same(found, truth);
        EXPECT_EQ(found.upper_bound, truth.upper_bound);
        EXPECT_EQ(found.nodes, truth.nodes);
      }
    }
  }
}

TEST(BranchAndBound, AnInterruptedSearchStillTellsTheTruth) {
  WorkerPool serial(1);
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    const SmallSpace s(seed);
    SearchOptions options;
    options.threshold = -1e6;
    const SearchOutcome truth = brute_force(s.search(), s.space, options);
    if (truth.found.empty()) continue;
    for (const int batches : {0, 1, 2, 3, 4, 5, 7, 10, 20}) {
      int left = batches;
      options.expired = [&left] { return left-- <= 0; };
      const SearchOutcome found = branch_and_bound(s.search(), options, serial);
      const double best = found.found.empty() ? -1e9 : found.found[0].score;
      EXPECT_GE(std::max(best, found.upper_bound), truth.found[0].score);
      EXPECT_LE(best, truth.found[0].score);
      if (!found.found.empty()) {
        const LatticePose& pose = found.found[0].pose;
        EXPECT_EQ(best, evaluate(s.bins[static_cast<std::size_t>(pose.bin)], s.problem.tables(), pose));
      }
    }
  }
}

}  // namespace
}  // namespace sextant
