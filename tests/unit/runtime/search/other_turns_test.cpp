// SPDX-License-Identifier: Apache-2.0
#include "runtime/search/other_turns.h"

#include <gtest/gtest.h>

#include <cmath>

#include "random_problem.h"
#include "runtime/search/seeds.h"

namespace sextant {
namespace {

int turn_of(const LatticePose& pose) { return pose.at[kRz] * kLatticeDegrees; }

TEST(OtherTurns, AreNearlyAsGoodElsewhereAndBestFirst) {
  int seen = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    RandomProblem p(seed);
    const Constraint constraint(p.camera(), 0.4, 1.4, std::nullopt);
    const SearchProblem problem{p.bins(), p.tables(), constraint, 0.1};
    const LatticePose found = p.pose_in(p.region(6));
    const double least = *score_of(problem, found) - 30;
    const auto others = other_turns(problem, found, 360, least, 2);
    EXPECT_LE(others.size(), 2U);
    double last = std::numeric_limits<double>::infinity();
    for (const ScoredPose& other : others) {
      EXPECT_GT(std::abs(turn_of(other.pose) - turn_of(found)), kSameTurnDeg);
      EXPECT_EQ(other.score, *score_of(problem, other.pose));
      EXPECT_GE(other.score, least);
      EXPECT_LE(other.score, last);
      last = other.score;
      ++seen;
    }
    if (others.size() == 2) {
      EXPECT_GT(std::abs(turn_of(others[0].pose) - turn_of(others[1].pose)), kSameTurnDeg);
    }
    // Every turn on the spot that is good enough is matched by the best one.
    for (std::size_t b = 0; b < p.bins().size(); ++b) {
      LatticePose pose = found;
      pose.bin = static_cast<int>(b);
      for (int turn = 0; turn < 36 / kLatticeDegrees; ++turn) {
        pose.at[kRz] = static_cast<std::int16_t>(turn);
        const auto score = score_of(problem, pose);
        if (!score || *score < least) continue;
        if (std::abs(turn_of(pose) - turn_of(found)) <= kSameTurnDeg + 12) continue;  // may climb back
        ASSERT_FALSE(others.empty());
        EXPECT_GE(others[0].score, *score);
      }
    }
  }
  EXPECT_GT(seen, 10);
}

TEST(OtherTurns, ARoundObjectHasNone) {
  RandomProblem p(1);
  const Constraint constraint(p.camera(), 0.4, 1.4, std::nullopt);
  const SearchProblem problem{p.bins(), p.tables(), constraint, 0.1};
  EXPECT_TRUE(other_turns(problem, p.pose_in(p.region(6)), 0, -1e9, 3).empty());
}

TEST(OtherTurns, TurnsThatLookAlikeAreTheSame) {
  RandomProblem p(1);
  const Constraint constraint(p.camera(), 0.4, 1.4, std::nullopt);
  const SearchProblem problem{p.bins(), p.tables(), constraint, 0.1};
  LatticePose found = p.pose_in(p.region(6));
  found.bin = 0;
  found.at[kRz] = 0;
  for (const ScoredPose& other : other_turns(problem, found, 30, -1e9, 3)) {
    EXPECT_GT(std::min(turn_of(other.pose) % 30, 30 - turn_of(other.pose) % 30), kSameTurnDeg);
  }
}

}  // namespace
}  // namespace sextant
