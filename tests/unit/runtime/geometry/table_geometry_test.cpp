// SPDX-License-Identifier: Apache-2.0
#include "runtime/geometry/table_geometry.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "runtime/geometry/pose_mapping.h"

namespace sextant {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kDegree = kPi / 180;
const PinholeCamera kCamera{640, 480, 525, 319.5, 239.5};

TEST(TableGeometry, PitchAndRollRoundTrip) {
  for (double pitch = -1.2; pitch < 1.3; pitch += 0.3) {
    for (double roll = -3; roll < 3.1; roll += 0.5) {
      const TableGeometry t = TableGeometry::from_pitch_roll(pitch, roll, 1);
      EXPECT_NEAR(t.up_in_camera.norm(), 1, 1e-12);
      EXPECT_NEAR(t.pitch_rad(), pitch, 1e-12);
      EXPECT_NEAR(t.roll_rad(), roll, 1e-12);
    }
  }
}

// Eqs. 5.12 and 5.15 at roll 0 hold exactly; 5.11 measures rx in the image plane, ours in the tangent
// plane with the opposite sign: they agree on the column through the principal point and drift apart
// towards the border.
TEST(TableGeometry, AgreesWithTheThesisAtRollZero) {
  for (double pitch = 10 * kDegree; pitch < 80 * kDegree; pitch += 7 * kDegree) {
    const TableGeometry table = TableGeometry::from_pitch_roll(pitch, 0, 1.3);
    const double drop = 1.2;
    for (double x = 0; x < 640; x += 31.5) {
      for (double y = 0; y < 480; y += 29) {
        const double px = (x - kCamera.cx) / kCamera.focal;
        const double py = (y - kCamera.cy) / kCamera.focal;
        const double n = std::sqrt(1 + px * px + py * py);
        const UprightPose up = upright_pose_at(kCamera, table.up_in_camera, x, y);
        EXPECT_NEAR(up.ry, -std::asin((std::sin(pitch) + py * std::cos(pitch)) / n), 1e-9);
        if (up.sine_of_elevation > 0.01) {
          EXPECT_NEAR(drop / up.sine_of_elevation, drop * n / (py * std::cos(pitch) + std::sin(pitch)), 1e-9);
        }
        const double tangent_rx =
            std::atan2(std::sin(pitch) * px * n, std::cos(pitch) * (1 + px * px) - std::sin(pitch) * py);
        EXPECT_NEAR(up.rx, tangent_rx, 1e-9);
      }
    }
    for (double y = 0; y < 480; y += 29) {
      const double thesis_rx = std::atan2(0.0, (kCamera.cy - y) * std::tan(pitch) + kCamera.focal);
      const double rx = upright_pose_at(kCamera, table.up_in_camera, kCamera.cx, y).rx;
      EXPECT_NEAR(std::remainder(rx + thesis_rx, 2 * kPi), 0, 1e-9);
    }
  }
}

TEST(TableGeometry, AnObjectPlacedUprightSatisfiesItsOwnConstraint) {
  const TableGeometry table = TableGeometry::from_pitch_roll(0.7, 0.2, 0.9);
  for (double x = 20; x < 640; x += 60) {
    for (double y = 20; y < 480; y += 60) {
      const UprightPose up = upright_pose_at(kCamera, table.up_in_camera, x, y);
      if (up.sine_of_elevation < 0.05) continue;
      const double z = (0.9 - 0.1) / up.sine_of_elevation;
      const Pose6 pose{x, y, z, up.rx, up.ry, 1.0};
      // The object's vertical is the table's normal, and its centre is 0.1 m above the table.
      const RigidTransform t = transform_from_pose(kCamera, pose);
      EXPECT_TRUE(t.linear().col(2).isApprox(table.up_in_camera, 1e-9));
      EXPECT_NEAR(-table.up_in_camera.dot(t.translation()), 0.8, 1e-9);
      TableTolerance tolerance;
      EXPECT_TRUE(table_constraint_contains(kCamera, table, 0.1, tolerance, pose));
      Pose6 off = pose;
      off.z += (tolerance.height_m + 1e-6) / up.sine_of_elevation;
      EXPECT_FALSE(table_constraint_contains(kCamera, table, 0.1, tolerance, off));
      off = pose;
      off.rx += tolerance.angle_rad + 1e-6;
      EXPECT_FALSE(table_constraint_contains(kCamera, table, 0.1, tolerance, off));
      off = pose;
      off.ry -= tolerance.angle_rad + 1e-6;
      EXPECT_FALSE(table_constraint_contains(kCamera, table, 0.1, tolerance, off));
    }
  }
}

// Procs. 22-27: every sampled pose of a rectangle lies inside the ranges, for any gravity direction.
TEST(TableGeometry, RangesContainEverySample) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int i = 0; i < 3000; ++i) {
    const TableGeometry table = TableGeometry::from_pitch_roll(
        (unit(random) * 1.8 - 0.3), (2 * unit(random) - 1) * kPi, 0.5 + unit(random));
    const double size = std::pow(2.0, 9 * unit(random));
    const double x0 = -50 + unit(random) * 700;
    const double y0 = -50 + unit(random) * 540;
    const Interval x{x0, x0 + size * unit(random)};
    const Interval y{y0, y0 + size * unit(random)};
    const UprightRange range = upright_range_over(kCamera, table.up_in_camera, x, y);
    TableTolerance tolerance;
    const Interval z = table_distance_range(table, 0.05, tolerance, range.sine_of_elevation);
    for (int k = 0; k < 60; ++k) {
      // Corners and edges are hit on purpose: extremes lie there.
      const double u = k < 4 ? (k & 1) : unit(random);
      const double v = k < 4 ? (k >> 1) : (k % 5 == 0 ? 0.0 : unit(random));
      const double sx = x.lo + u * (x.hi - x.lo);
      const double sy = y.lo + v * (y.hi - y.lo);
      const UprightPose up = upright_pose_at(kCamera, table.up_in_camera, sx, sy);
      ASSERT_TRUE(range.sine_of_elevation.contains(up.sine_of_elevation));
      ASSERT_TRUE(range.ry.contains(up.ry));
      ASSERT_TRUE(range.rx.contains(up.rx)) << up.rx << " not in " << range.rx.lo << " " << range.rx.hi;
      if (up.sine_of_elevation > 1e-6) {
        const double height = table.camera_height_m - 0.05 + (2 * unit(random) - 1) * tolerance.height_m;
        ASSERT_TRUE(z.contains(height / up.sine_of_elevation));
      }
    }
  }
}

TEST(TableGeometry, RangesShrinkWithTheRectangle) {
  const TableGeometry table = TableGeometry::from_pitch_roll(0.75, 0.05, 1);
  double last = 10;
  for (double size : {64.0, 16.0, 4.0, 1.0, 0.0}) {
    const UprightRange r =
        upright_range_over(kCamera, table.up_in_camera, {500, 500 + size}, {300, 300 + size});
    EXPECT_LT(r.rx.hi - r.rx.lo, last);
    last = r.rx.hi - r.rx.lo;
  }
  EXPECT_LT(last, 1e-6);
}

TEST(TableGeometry, RaysAboveTheHorizonMeetNoTable) {
  const TableGeometry table = TableGeometry::from_pitch_roll(0.0, 0, 1);
  const UprightRange r = upright_range_over(kCamera, table.up_in_camera, {0, 640}, {0, 100});
  EXPECT_TRUE(table_distance_range(table, 0, {}, r.sine_of_elevation).empty());
  EXPECT_FALSE(table_constraint_contains(kCamera, table, 0, {}, {320, 50, 1, 0, 0.3, 0}));
}

}  // namespace
}  // namespace sextant
