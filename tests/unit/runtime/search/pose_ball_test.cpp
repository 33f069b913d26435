// SPDX-License-Identifier: Apache-2.0
// A ball's region test against its pose test, and symmetry.
#include "runtime/search/pose_ball.h"

#include <gtest/gtest.h>

#include "random_problem.h"
#include "runtime/geometry/pose_mapping.h"

namespace sextant {
namespace {

TEST(PoseBall, AWholeRegionInsideHasAllItsPosesInside) {
  RandomProblem p(1);
  int inside = 0;
  int poses_inside = 0;
  for (int round = 0; round < 4000; ++round) {
    Region r = p.region(round % 2 ? 3 : 8);
    const LatticePose centre = p.pose_in(r);
    const BallSize size{p.uniform(0.01, 0.3), p.uniform(0.02, 0.5), round % 3 ? 360 : 0};
    const PoseBall ball(p.camera(), centre, size);
    EXPECT_TRUE(ball.contains(centre));
    const bool all = ball.contains_all(r);
    inside += all ? 1 : 0;
    for (int i = 0; i < 20; ++i) {
      const bool one = ball.contains(p.pose_in(r));
      poses_inside += one ? 1 : 0;
      EXPECT_TRUE(one || !all);
    }
  }
  EXPECT_GT(inside, 300);
  EXPECT_LT(poses_inside, 4000 * 19);
}

TEST(PoseBall, ASinglePoseIsARegion) {
  RandomProblem p(2);
  int inside = 0;
  for (int round = 0; round < 2000; ++round) {
    const Region r = p.region(6);
    const PoseBall ball(p.camera(), p.pose_in(r), {0.021, 0.1, 360});
    const LatticePose pose = p.pose_in(r);
    const bool contained = ball.contains(pose);
    EXPECT_EQ(contained, ball.contains_all({pose.bin, pose.at, pose.at})) << round;
    inside += contained ? 1 : 0;
  }
  EXPECT_GT(inside, 100);
}

TEST(PoseBall, IsTheDistanceAndTheAngleBetweenTheRigidPoses) {
  RandomProblem p(3);
  for (int round = 0; round < 2000; ++round) {
    const Region r = p.region(20);
    const LatticePose a = p.pose_in(r), b = p.pose_in(r);
    const RigidTransform ta = transform_from_pose(p.camera(), pose_of(a));
    const RigidTransform tb = transform_from_pose(p.camera(), pose_of(b));
    const double distance = (ta.translation() - tb.translation()).norm();
    const double angle = rotation_angle_between(ta, tb);
    EXPECT_TRUE(PoseBall(p.camera(), a, {distance + 1e-6, angle + 1e-6, 360}).contains(b));
    EXPECT_FALSE(PoseBall(p.camera(), a, {distance - 1e-6, angle + 1e-6, 360}).contains(b) && distance > 0);
    EXPECT_FALSE(PoseBall(p.camera(), a, {distance + 1e-6, angle - 1e-6, 360}).contains(b) && angle > 1e-3);
  }
}

TEST(PoseBall, TurnsThatLookAlikeAreInside) {
  RandomProblem p(4);
  const LatticePose a{0, {30, 20, 200, 1, -20, 3}};
  for (const int turn : {0, 46, 90, 180}) {
    LatticePose b = a;
    b.at[kRz] = static_cast<std::int16_t>(a.at[kRz] + turn / kLatticeDegrees);
    const auto alike = [&](int symmetry) {
      return PoseBall(p.camera(), a, {0.01, 0.1, symmetry}).contains(b);
    };
    EXPECT_TRUE(alike(0)) << turn;
    EXPECT_EQ(alike(90), turn % 90 == 0) << turn;
    EXPECT_EQ(alike(180), turn % 180 == 0) << turn;
    EXPECT_EQ(alike(360), turn == 0) << turn;
  }
}

}  // namespace
}  // namespace sextant
