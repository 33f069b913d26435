// SPDX-License-Identifier: Apache-2.0
#include "runtime/detect/resting_poses.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace sextant {
namespace {

Box2 at(double x) { return {x, 0, x + 10, 10}; }

TEST(RestingPoses, TheBetterRestingPoseOfOnePlaceIsReported) {
  const auto kept = one_per_place({{0, 80, at(0)}, {1, 90, at(1)}}, {{0, 80}, {1, 90}}, 1);
  ASSERT_EQ(kept.size(), 1U);
  EXPECT_EQ(kept[0].answer, 1U);
  EXPECT_EQ(kept[0].upper_bound, 90);
  EXPECT_EQ(kept[0].rival, 80);
  EXPECT_TRUE(kept[0].rival_exact);
}

TEST(RestingPoses, TwoPlacesAreTwoObjects) {
  const auto kept = one_per_place({{0, 80, at(0)}, {1, 90, at(50)}}, {{0, 10}, {1, 12}}, 5);
  ASSERT_EQ(kept.size(), 2U);
  EXPECT_EQ(kept[0].answer, 1U);
  EXPECT_EQ(kept[1].answer, 0U);
  for (const RestingChoice& k : kept) EXPECT_EQ(k.upper_bound, 12);
  EXPECT_EQ(kept[0].rival, 10);  // what the other model did not find
  EXPECT_FALSE(kept[0].rival_exact);
  EXPECT_EQ(kept[1].rival, 12);
}

TEST(RestingPoses, TheBestRemainWhereFewerAreWanted) {
  const auto kept = one_per_place({{0, 80, at(0)}, {0, 70, at(30)}, {1, 90, at(60)}, {1, 75, at(90)}},
                                  {{0, 70}, {1, 75}}, 2);
  ASSERT_EQ(kept.size(), 2U);
  EXPECT_EQ(kept[0].answer, 2U);
  EXPECT_EQ(kept[1].answer, 0U);
  EXPECT_EQ(kept[1].upper_bound, 75);
}

TEST(RestingPoses, AnInterruptedModelBoundsTheOthers) {
  const auto kept = one_per_place({{0, 80, at(0)}}, {{0, 80}, {1, 95}}, 1);
  ASSERT_EQ(kept.size(), 1U);
  EXPECT_EQ(kept[0].upper_bound, 95);
  EXPECT_EQ(kept[0].rival, 95);
  EXPECT_FALSE(kept[0].rival_exact);
  EXPECT_TRUE(one_per_place({}, {{0, 1}, {1, 2}}, 3).empty());
}

/// Each model searches for its best `most` poses by itself; whatever it left out, because there were better
/// ones or because one of its own suppressed it, the bound covers it unless a reported answer suppresses it.
TEST(RestingPoses, TheBoundHoldsForEveryPoseOfEveryModel) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(0, 100);
  std::uniform_real_distribution<double> score(0, 100);
  constexpr double kThreshold = 20;
  for (int round = 0; round < 2000; ++round) {
    const int most = 1 + round % 4;
    std::vector<RestingAnswer> poses;
    for (std::size_t i = 0; i < 24; ++i) poses.push_back({i % 3, score(random), at(place(random))});
    const auto hides = [](const RestingAnswer& a, const RestingAnswer& b) {
      return intersection_over_union(a.box, b.box) > kSuppressionIou;
    };
    std::vector<RestingAnswer> found;
    std::vector<RestingBound> bounds;
    for (std::size_t m = 0; m < 3; ++m) {
      std::vector<RestingAnswer> own;
      for (const RestingAnswer& p : poses) {
        if (p.model == m && p.score >= kThreshold) own.push_back(p);
      }
      std::sort(own.begin(), own.end(),
                [](const RestingAnswer& a, const RestingAnswer& b) { return a.score > b.score; });
      std::vector<RestingAnswer> best;
      for (const RestingAnswer& p : own) {
        if (static_cast<int>(best.size()) == most) break;
        if (std::none_of(best.begin(), best.end(), [&](const RestingAnswer& b) { return hides(b, p); }))
          best.push_back(p);
      }
      bounds.push_back({m, static_cast<int>(best.size()) == most ? best.back().score : kThreshold});
      found.insert(found.end(), best.begin(), best.end());
    }
    const auto kept = one_per_place(found, bounds, most);
    EXPECT_LE(kept.size(), static_cast<std::size_t>(most));
    for (const RestingAnswer& p : poses) {
      bool reported = false;
      bool hidden = false;
      for (const RestingChoice& k : kept) {
        const RestingAnswer& a = found[k.answer];
        reported |= a.model == p.model && a.score == p.score;
        hidden |= a.score >= p.score && hides(a, p);
      }
      if (reported || hidden) continue;
      for (const RestingChoice& k : kept) {
        EXPECT_LE(p.score, k.upper_bound) << round;
        // The rival speaks of what is not reported, suppressed or not, of the other models.
        if (p.model == found[k.answer].model) continue;
        EXPECT_LE(p.score, k.rival) << round;
      }
    }
    for (std::size_t i = 1; i < kept.size(); ++i) {
      EXPECT_LE(found[kept[i].answer].score, found[kept[i - 1].answer].score);
      for (std::size_t j = 0; j < i; ++j) EXPECT_FALSE(hides(found[kept[i].answer], found[kept[j].answer]));
    }
  }
}

}  // namespace
}  // namespace sextant
