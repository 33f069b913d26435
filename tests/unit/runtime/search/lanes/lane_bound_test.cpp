// SPDX-License-Identifier: Apache-2.0
// The vector bound: the same integers as its plain twin on every CPU target, and never above the exact cost.
#include "runtime/search/lanes/lane_bound.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include "../random_problem.h"
#include "runtime/search/evaluate.h"

namespace sextant {
namespace {

/// A random problem with everything that a lane bound needs.
struct LaneProblem {
  RandomProblem random;
  LaneTables lanes;
  Constraint constraint;
  double floor;
  std::vector<LaneBin> bins;

  explicit LaneProblem(std::uint64_t seed, bool with_table = true)
      : random(seed, 150, 110),
        constraint(random.camera(), 0.4, 1.4,
                   with_table ? std::optional<TableConstraint>(random.table()) : std::nullopt),
        floor(random.uniform(-300, 0)) {
    WorkerPool serial(1);
    lanes.build(random.tables(), serial);
    for (const ScoredBin& bin : random.bins()) bins.push_back(lane_bin(bin, floor));
  }
  LaneFrame frame() const {
    return {lanes, random.camera(), constraint.nearest_index(), constraint.farthest_index()};
  }
  /// A random node of a random tile.
  LaneNode node(const LaneTile& tile, int most) {
    LaneNode n;
    n.stage = static_cast<std::uint8_t>(tile.stage);
    n.x0 = static_cast<std::int16_t>(tile.x0);
    n.y0 = static_cast<std::int16_t>(tile.y0);
    n.alive = tile.feasible & ~(std::uint64_t{1} << random.whole(0, 63));
    n.bin = random.whole(0, static_cast<int>(bins.size()) - 1);
    const RotationBox& box = bins[static_cast<std::size_t>(n.bin)].box;
    for (std::size_t a = 0; a < 3; ++a) {
      const int lo = random.whole(box.lo_deg[a], box.hi_deg[a] - 1);
      n.lo[a] = static_cast<std::int16_t>(lo);
      n.hi[a] = static_cast<std::int16_t>(std::min(box.hi_deg[a] - 1, lo + random.whole(0, most)));
    }
    const int lo = random.whole(tile.offset_lo, tile.offset_hi);
    n.offset_lo = static_cast<std::int16_t>(lo);
    n.offset_hi = static_cast<std::int16_t>(std::min(tile.offset_hi, lo + random.whole(0, most)));
    return n;
  }
  LaneTile tile(int stage) {
    const int cell = kLaneStages[static_cast<std::size_t>(stage)].cell;
    const int x = random.whole(0, (random.camera().width - 1) / (kLaneColumns * cell)) * kLaneColumns * cell;
    const int y = random.whole(0, (random.camera().height - 1) / (kLaneRows * cell)) * kLaneRows * cell;
    return lane_tile(constraint, stage, x, y);
  }
};

TEST(LaneBound, EveryCpuTargetGivesTheIntegersOfThePlainTwin) {
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
      LaneProblem p(seed, seed % 3 != 0);
      for (int i = 0; i < 60; ++i) {
        const LaneTile tile = p.tile(i % static_cast<int>(kLaneStages.size()));
        if (tile.feasible == 0) continue;
        const LaneNode node = p.node(tile, p.random.whole(0, 12));
        const auto budget = static_cast<std::uint16_t>(p.random.whole(0, 65534));
        const LaneBin& bin = p.bins[static_cast<std::size_t>(node.bin)];
        LaneCosts fast;
        LaneCosts plain;
        lane_bound(p.frame(), bin, tile, node, budget, fast);
        lane_bound_plain(p.frame(), bin, tile, node, budget, plain);
        ASSERT_EQ(fast.alive, plain.alive) << hwy::TargetName(target);
        ASSERT_EQ(fast.units, plain.units) << hwy::TargetName(target);
        ASSERT_EQ(fast.parts, plain.parts);
      }
    }
  }
  hwy::SetSupportedTargetsForTest(0);
}

TEST(LaneBound, NeverExceedsTheExactCost) {
  int checked = 0;
  int exact = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    LaneProblem p(seed, seed % 4 != 0);
    for (int i = 0; i < 90; ++i) {
      const LaneTile tile = p.tile(i % static_cast<int>(kLaneStages.size()));
      if (tile.feasible == 0) continue;
      const LaneNode node = p.node(tile, i % 4 == 0 ? 0 : p.random.whole(0, 16));
      const LaneBin& bin = p.bins[static_cast<std::size_t>(node.bin)];
      const ScoredBin& scored = p.random.bins()[static_cast<std::size_t>(node.bin)];
      LaneCosts costs;
      lane_bound(p.frame(), bin, tile, node, 65534, costs);
      const int cell = kLaneStages[static_cast<std::size_t>(tile.stage)].cell;
      for (int sample = 0; sample < 40; ++sample) {
        const int lane = p.random.whole(0, kLanes - 1);
        if (((node.alive >> lane) & 1U) == 0) continue;
        LatticePose pose{node.bin, {}};
        pose.at[kX] =
            static_cast<std::int16_t>(tile.x0 + lane % kLaneColumns * cell + p.random.whole(0, cell - 1));
        pose.at[kY] =
            static_cast<std::int16_t>(tile.y0 + lane / kLaneColumns * cell + p.random.whole(0, cell - 1));
        const int z = anchor_distance(p.constraint, pose.at[kX], pose.at[kY]) +
                      p.random.whole(node.offset_lo, node.offset_hi);
        pose.at[kZ] = static_cast<std::int16_t>(z);
        for (std::size_t a = 0; a < 3; ++a)
          pose.at[kRx + a] = static_cast<std::int16_t>(p.random.whole(node.lo[a], node.hi[a]));
        const PinholeCamera& camera = p.random.camera();
        if (pose.at[kX] >= camera.width || pose.at[kY] >= camera.height || z < p.constraint.nearest_index() ||
            z > p.constraint.farthest_index() || !p.constraint.contains(pose)) {
          continue;
        }
        ++checked;
        const double score = evaluate(scored, p.random.tables(), pose);
        const std::uint16_t units = costs.units[static_cast<std::size_t>(lane)];
        if (units == 65535) {
          // Dead: only where it costs more than 16 bits hold.
          ASSERT_LT(score, p.floor) << "seed " << seed;
          continue;
        }
        ASSERT_GE(score_bound(bin, units), score) << "seed " << seed << " stage " << tile.stage;
        ASSERT_LE(units, budget_units(bin, score));
        if (node.single() && cell == 1 && score_bound(bin, units) - score < 0.05 * (bin.offset - score))
          ++exact;
      }
    }
  }
  EXPECT_GT(checked, 3000);
  EXPECT_GT(exact, 30) << "single poses should be bounded to within 5 % of their cost";
}

TEST(LaneTile, HoldsEveryFeasiblePoseOfItsLanes) {
  int feasible = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    LaneProblem p(seed);
    for (int i = 0; i < 1500; ++i) {
      const LaneTile tile = p.tile(i % static_cast<int>(kLaneStages.size()));
      const int cell = kLaneStages[static_cast<std::size_t>(tile.stage)].cell;
      const auto lane = static_cast<std::size_t>(p.random.whole(0, kLanes - 1));
      const int x = tile.x0 + static_cast<int>(lane) % kLaneColumns * cell + p.random.whole(0, cell - 1);
      const int y = tile.y0 + static_cast<int>(lane) / kLaneColumns * cell + p.random.whole(0, cell - 1);
      if (x >= p.random.camera().width || y >= p.random.camera().height) continue;
      const int anchor = anchor_distance(p.constraint, x, y);
      LatticePose pose{0, {}};
      pose.at = {static_cast<std::int16_t>(x),
                 static_cast<std::int16_t>(y),
                 static_cast<std::int16_t>(std::clamp(anchor + p.random.whole(-12, 12), 1, 1500)),
                 static_cast<std::int16_t>(p.random.whole(-10, 10)),
                 static_cast<std::int16_t>(p.random.whole(-35, -5)),
                 0};
      if (pose.at[kZ] < p.constraint.nearest_index() || pose.at[kZ] > p.constraint.farthest_index()) continue;
      if (!p.constraint.contains(pose)) continue;
      ++feasible;
      ASSERT_TRUE((tile.feasible >> lane) & 1U);
      const int offset = pose.at[kZ] - anchor;
      ASSERT_LE(tile.offset_lo, offset);
      ASSERT_GE(tile.offset_hi, offset);
      ASSERT_LE(tile.anchor_lo[lane], anchor);
      ASSERT_GE(tile.anchor_hi[lane], anchor);
      ASSERT_LE(tile.rx_lo[lane], pose.at[kRx]);
      ASSERT_GE(tile.rx_hi[lane], pose.at[kRx]);
      ASSERT_LE(tile.ry_lo[lane], pose.at[kRy]);
      ASSERT_GE(tile.ry_hi[lane], pose.at[kRy]);
    }
  }
  EXPECT_GT(feasible, 150);
}

}  // namespace
}  // namespace sextant
