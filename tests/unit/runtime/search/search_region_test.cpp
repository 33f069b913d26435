// SPDX-License-Identifier: Apache-2.0
// A region of interest restricts the space exactly: the searches against brute force with a filter.
#include "runtime/search/search_region.h"

#include <gtest/gtest.h>

#include <optional>

#include "lanes/prepared_target.h"
#include "runtime/geometry/pose_mapping.h"
#include "runtime/search/evaluate.h"
#include "runtime/search/reference/brute_force.h"
#include "small_space.h"

namespace sextant {
namespace {

bool inside(const SearchRegion& region, const PinholeCamera& camera, const LatticePose& pose) {
  const Pose6 p = pose_of(pose);
  if (region.image && (p.x < region.image->x0 || p.x > region.image->x1 || p.y < region.image->y0 ||
                       p.y > region.image->y1)) {
    return false;
  }
  if (!region.workspace) return true;
  const Eigen::Vector3d c =
      region.workspace->workspace_from_camera * transform_from_pose(camera, p).translation();
  for (int i = 0; i < 3; ++i) {
    if (c[i] < region.workspace->lo[i] || c[i] > region.workspace->hi[i]) return false;
  }
  return true;
}

/// A box that holds some of the space's centres and not others.
WorkspaceBox box_around(SmallSpace& s, double size) {
  WorkspaceBox box;
  box.workspace_from_camera = table_from_camera(s.standing.table);
  const PinholeCamera& camera = s.problem.camera();
  const Eigen::Vector3d middle =
      box.workspace_from_camera *
      (s.problem.uniform(0.9, 0.92) *
       camera.ray(s.problem.uniform(2, camera.width - 2), s.problem.uniform(2, camera.height - 2)));
  for (int i = 0; i < 3; ++i) {
    box.lo[i] = middle[i] - s.problem.uniform(0.2, 1) * size;
    box.hi[i] = middle[i] + s.problem.uniform(0.2, 1) * size;
  }
  return box;
}

TEST(SearchRegion, IsAnExactRestriction) {
  WorkerPool serial(1);
  int found = 0, other = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    SmallSpace s(seed, 20, 14, 0.9, 0.915);
    const PinholeCamera& camera = s.problem.camera();
    SearchRegion region;
    if (seed % 3 != 1) {
      const int x = s.problem.whole(-3, 15), y = s.problem.whole(-3, 10);
      region.image = PixelRectangle{x, y, x + s.problem.whole(0, 9), y + s.problem.whole(0, 9)};
    }
    if (seed % 3 != 0) region.workspace = box_around(s, 0.15);
    const Constraint restricted(camera, 0.9, 0.915, s.standing, region);
    const double threshold = -1e6;
    std::optional<ScoredPose> best, best_anywhere;
    for (const Region& all : s.space) {
      for_each_pose(all, [&](const LatticePose& pose) {
        const bool feasible = s.constraint.contains(pose);
        ASSERT_EQ(restricted.contains(pose), feasible && inside(region, camera, pose));
        if (!feasible) return;
        const double score = evaluate(s.bins[static_cast<std::size_t>(pose.bin)], s.problem.tables(), pose);
        if (!best_anywhere || score > best_anywhere->score) best_anywhere = ScoredPose{pose, score};
        if (inside(region, camera, pose) && (!best || score > best->score)) best = ScoredPose{pose, score};
      });
    }
    SearchOptions options;
    options.threshold = threshold;
    const SearchOutcome plain =
        branch_and_bound({s.bins, s.problem.tables(), restricted, 0.1}, options, serial);
    const PreparedTarget prepared(s.bins, restricted, 1, threshold);
    const SearchOutcome lanes = run_lanes(s.problem.tables(), prepared, serial);
    for (const SearchOutcome* o : {&plain, &lanes}) {
      ASSERT_TRUE(o->complete);
      ASSERT_EQ(o->found.size(), best ? 1U : 0U) << "seed " << seed;
      if (!best) continue;
      EXPECT_EQ(o->found[0].pose, best->pose) << "seed " << seed;
      EXPECT_EQ(o->found[0].score, best->score) << "seed " << seed;
    }
    found += best ? 1 : 0;
    other += best && best->pose != best_anywhere->pose ? 1 : 0;
  }
  EXPECT_GT(found, 10);
  EXPECT_GT(other, 5);
}

TEST(SearchRegion, WithoutATableTheWorkspaceLimitsDistancesAlone) {
  WorkerPool serial(1);
  int found = 0;
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    SmallSpace s(seed, 20, 14, 0.9, 0.915);
    SearchRegion region;
    region.workspace = box_around(s, 0.1);
    const Constraint restricted(s.problem.camera(), 0.7, 1.1, std::nullopt, region);
    SearchOptions options;
    options.threshold = 0.65 * s.bins[0].worst + 0.35 * s.bins[0].offset;
    const SearchOutcome plain =
        branch_and_bound({s.bins, s.problem.tables(), restricted, 0.1}, options, serial);
    const PreparedTarget prepared(s.bins, restricted, 1, options.threshold);
    const SearchOutcome lanes = run_lanes(s.problem.tables(), prepared, serial);
    ASSERT_EQ(plain.found.size(), lanes.found.size());
    if (plain.found.empty()) continue;
    ++found;
    EXPECT_EQ(plain.found[0].pose, lanes.found[0].pose);
    EXPECT_TRUE(inside(region, s.problem.camera(), plain.found[0].pose));
  }
  EXPECT_GT(found, 0);
}

TEST(SearchRegion, DistancesOverARectangleLoseNothing) {
  RandomProblem p(7);
  int met = 0, empty = 0;
  for (int round = 0; round < 12000; ++round) {
    WorkspaceBox box;
    box.workspace_from_camera.linear() =
        Eigen::Quaterniond(p.uniform(-1, 1), p.uniform(-1, 1), p.uniform(-1, 1), p.uniform(-1, 1))
            .normalized()
            .toRotationMatrix();
    box.workspace_from_camera.translation() = Eigen::Vector3d(p.uniform(-1, 1), p.uniform(-1, 1), 0.5);
    for (int i = 0; i < 3; ++i) {
      box.lo[i] = p.uniform(-1, 1);
      box.hi[i] = box.lo[i] + p.uniform(0, 0.5);
    }
    const double x = p.uniform(0, 70), y = p.uniform(0, 50), side = p.uniform(0, 8);
    const Interval z = box.distances_over(p.camera(), {x, x + side}, {y, y + side});
    empty += z.empty() ? 1 : 0;
    for (int i = 0; i < 30; ++i) {
      const double distance = p.uniform(0.05, 2);
      const Eigen::Vector3d point =
          distance * p.camera().ray(x + p.uniform(0, 1) * side, y + p.uniform(0, 1) * side);
      if (!box.contains(point)) continue;
      ++met;
      EXPECT_TRUE(z.contains(distance)) << round;
    }
  }
  EXPECT_GT(met, 100);
  EXPECT_GT(empty, 100);
}

TEST(SearchRegion, TheTablesFrameIsBelowTheCamera) {
  const TableGeometry table = TableGeometry::from_pitch_roll(0.7, 0.2, 0.8);
  const RigidTransform t = table_from_camera(table);
  EXPECT_NEAR((t.linear() * t.linear().transpose() - Eigen::Matrix3d::Identity()).norm(), 0, 1e-12);
  EXPECT_NEAR(t.linear().determinant(), 1, 1e-12);
  // The camera itself, and what it looks at: in front of it, in no other direction.
  EXPECT_NEAR((t.translation() - Eigen::Vector3d(0, 0, 0.8)).norm(), 0, 1e-12);
  const Eigen::Vector3d ahead = t.linear() * Eigen::Vector3d::UnitZ();
  EXPECT_GT(ahead.x(), 0);
  EXPECT_NEAR(ahead.y(), 0, 1e-12);
  EXPECT_NEAR(ahead.z(), -std::sin(0.7), 1e-12);
}

TEST(SearchRegion, ARectangleIsTheSamePixelsWhereNothingIsRectified) {
  CameraModel camera{640, 480, 525, 525, 319.5, 239.5, {}};
  const PixelRectangle r = rectified_rectangle(camera, camera.ideal(), 100, 80, 320, 240);
  EXPECT_EQ(r.x0, 100);
  EXPECT_EQ(r.y0, 80);
  EXPECT_EQ(r.x1, 419);
  EXPECT_EQ(r.y1, 319);
  camera.distortion = {0.1, -0.05, 0.001, 0.001, 0, 0, 0, 0};
  const PinholeCamera ideal = camera.ideal();
  const PixelRectangle bent = rectified_rectangle(camera, ideal, 100, 80, 320, 240);
  for (int x = 100; x < 420; x += 7) {
    for (int y = 80; y < 320; y += 7) {
      const Eigen::Vector2d t = camera.undistorted_tangent(x, y);
      const double u = ideal.cx + ideal.focal * t.x(), v = ideal.cy + ideal.focal * t.y();
      EXPECT_TRUE(u >= bent.x0 && u <= bent.x1 && v >= bent.y0 && v <= bent.y1);
    }
  }
}

}  // namespace
}  // namespace sextant
