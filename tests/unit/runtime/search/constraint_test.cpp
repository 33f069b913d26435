// SPDX-License-Identifier: Apache-2.0
#include "runtime/search/constraint.h"

#include <gtest/gtest.h>

#include "random_problem.h"
#include "runtime/search/suppression.h"

namespace sextant {
namespace {

// CONSTRAINT-INTERSECT never loses a feasible pose.
TEST(Constraint, TighteningKeepsEveryFeasiblePose) {
  int feasible = 0;
  int shrunk = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    RandomProblem p(seed);
    const Constraint constraint(p.camera(), 0.4, 1.4, p.table());
    for (int i = 0; i < 100; ++i) {
      const Region r = p.region(1 << (i % 9));
      const Region t = constraint.tightened(r);
      shrunk += t == r ? 0 : 1;
      for (int k = 0; k < 60; ++k) {
        const LatticePose pose = p.pose_in(r);
        if (!constraint.contains(pose)) continue;
        ++feasible;
        ASSERT_TRUE(t.contains(pose));
      }
    }
  }
  EXPECT_GT(feasible, 500);
  EXPECT_GT(shrunk, 1000);
}

TEST(Constraint, WithoutATableEverythingIsFeasible) {
  RandomProblem p(1);
  const Constraint constraint(p.camera(), 0.5, 2, std::nullopt);
  const Region r = constraint.whole(0, {{-10, -50, 0}, {10, -30, 20}});
  EXPECT_NEAR(r.lo[kZ] * kLatticeDistance, 0.5, 1e-9);
  EXPECT_NEAR(r.hi[kZ] * kLatticeDistance, 2, 1e-9);
  EXPECT_EQ(r.hi[kRx], last_angle(10));  // half-open box of degrees, closed lattice region
  EXPECT_EQ(constraint.tightened(r), r);
  EXPECT_TRUE(constraint.contains(p.pose_in(r)));
  EXPECT_EQ(constraint.coverage({}), 1);
}

TEST(Constraint, CoverageTellsWhatTheBinsMiss) {
  RandomProblem p(1);
  const TableConstraint table{TableGeometry::from_pitch_roll(0.7, 0, 1), {0.01, 0.2}, 0.05};
  const Constraint constraint(p.camera(), 0.1, 10, table);
  ViewpointBin all;
  all.box = {{-180, -90, 0}, {180, 90, 360}};
  EXPECT_EQ(constraint.coverage({all}), 1);
  ViewpointBin upper = all;
  upper.box.lo_deg[1] = -40;  // elevations above 40 deg are missing: about half of a view at 40 deg pitch
  EXPECT_GT(constraint.coverage({upper}), 0.2);
  EXPECT_LT(constraint.coverage({upper}), 0.8);
  EXPECT_EQ(constraint.coverage({}), 0);
}

TEST(Suppression, ARegionIsSuppressedOnlyIfEveryPoseIs) {
  int suppressed = 0;
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    RandomProblem p(seed);
    for (int i = 0; i < 200; ++i) {
      const Region r = p.region(1 << (i % 5));
      const ScoredBin& bin = p.bins()[static_cast<std::size_t>(r.bin)];
      LatticePose near = p.pose_in(r);
      near.at[kX] = static_cast<std::int16_t>(near.at[kX] + p.whole(-2, 2));
      const Box2 detection = box_of(bin, p.camera().focal, near);
      if (!suppressed_everywhere(bin, p.camera().focal, r, detection)) continue;
      ++suppressed;
      for (int k = 0; k < 50; ++k) {
        ASSERT_GT(intersection_over_union(box_of(bin, p.camera().focal, p.pose_in(r)), detection),
                  kSuppressionIou);
      }
    }
  }
  EXPECT_GT(suppressed, 300);
}

}  // namespace
}  // namespace sextant
