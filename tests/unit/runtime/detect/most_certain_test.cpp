// SPDX-License-Identifier: Apache-2.0
#include "runtime/detect/most_certain.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace sextant {
namespace {

PoseEstimate estimate(int object, double log_score, double confidence, double upper_bound) {
  PoseEstimate e;
  e.object_id = 1;
  e.model_index = static_cast<std::size_t>(object);
  e.log_score = log_score;
  e.score = confidence;
  e.upper_bound = upper_bound;
  e.gap = std::max(0.0, upper_bound - log_score);
  e.runner_up_margin = 5;
  e.status = SearchStatus::kOptimal;
  return e;
}

using Indices = std::vector<std::size_t>;

/// Where no estimate was turned.
Indices kept(std::vector<PoseEstimate>& estimates, const Indices& object_of, int most) {
  std::vector<double> found;
  for (const PoseEstimate& e : estimates) found.push_back(e.log_score);
  return keep_most_certain(estimates, found, object_of, most);
}

/// Every model is an object of its own.
const Indices kAlone{0, 1, 2};

TEST(MostCertain, TheBestScoreRemainsWhereItIsAlsoTheMostCertain) {
  std::vector<PoseEstimate> e{estimate(1, 90, 0.9, 70), estimate(1, 80, 0.2, 70), estimate(1, 70, 0.1, 70)};
  EXPECT_EQ(kept(e, kAlone, 1), Indices{0});
  EXPECT_EQ(e[0].status, SearchStatus::kOptimal);
  EXPECT_EQ(e[0].gap, 0);
  EXPECT_EQ(e[0].upper_bound, 80);
  EXPECT_EQ(e[0].runner_up_margin, 5);  // the dropped one is farther than that below
  e = {estimate(1, 90, 0.9, 70), estimate(1, 88, 0.2, 70)};
  kept(e, kAlone, 1);
  EXPECT_EQ(e[0].runner_up_margin, 2);
  EXPECT_TRUE(e[0].runner_up_exact);
}

TEST(MostCertain, AnotherPlaceThanTheOptimumIsBoundedByIt) {
  std::vector<PoseEstimate> e{estimate(1, 90, 0.1, 70), estimate(1, 80, 0.7, 70), estimate(1, 70, 0.6, 70)};
  EXPECT_EQ(kept(e, kAlone, 1), Indices{1});
  EXPECT_EQ(e[1].status, SearchStatus::kBounded);
  EXPECT_EQ(e[1].upper_bound, 90);
  EXPECT_EQ(e[1].gap, 10);
  EXPECT_EQ(e[1].runner_up_margin, 0);
  EXPECT_FALSE(e[1].runner_up_exact);
}

TEST(MostCertain, WhatWasTurnedAndDroppedCountsWithTheScoreThatWasFound) {
  std::vector<PoseEstimate> e{estimate(1, 78, 0.1, 90), estimate(1, 80, 0.7, 70)};
  EXPECT_EQ(keep_most_certain(e, {90, 80}, kAlone, 1), Indices{1});
  EXPECT_EQ(e[1].status, SearchStatus::kBounded);
  EXPECT_EQ(e[1].upper_bound, 90);
  EXPECT_EQ(e[1].gap, 10);
}

TEST(MostCertain, EachObjectHasItsOwnAndTheOrderRemains) {
  std::vector<PoseEstimate> e{estimate(2, 90, 0.1, 60), estimate(2, 80, 0.7, 60), estimate(1, 70, 0.2, 50),
                              estimate(2, 60, 0.8, 60), estimate(1, 50, 0.2, 50)};
  EXPECT_EQ(kept(e, kAlone, 2), (Indices{1, 2, 3, 4}));
  EXPECT_EQ(e[1].gap, 10);
  EXPECT_EQ(e[3].gap, 30);
  EXPECT_EQ(e[2].status, SearchStatus::kOptimal);
  EXPECT_EQ(kept(e, kAlone, 1), (Indices{2, 3}));  // equal confidence: the better score
  std::vector<PoseEstimate> two{estimate(2, 90, 0.1, 60), estimate(1, 80, 0.7, 60)};
  EXPECT_EQ(kept(two, {0, 1, 1}, 1), Indices{1});  // two resting poses of one object
  std::vector<PoseEstimate> none;
  EXPECT_TRUE(kept(none, kAlone, 1).empty());
}

}  // namespace
}  // namespace sextant
