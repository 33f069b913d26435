// SPDX-License-Identifier: Apache-2.0
// The camera over the table: gravity and height, for any roll of the camera, and what they demand of the
// pose of an object standing on it (Davies 2015, eqs. 5.11-5.15, generalised; METHOD.md section 4.3).
#pragma once

#include <Eigen/Core>

#include "runtime/geometry/camera_model.h"
#include "runtime/geometry/interval.h"
#include "runtime/geometry/pose6.h"

namespace sextant {

/// Where the table is, seen from the camera.
struct TableGeometry {
  Eigen::Vector3d up_in_camera{0, -1, 0};  ///< unit normal of the table, away from it
  double camera_height_m = 0;              ///< of the focal point above the table plane, > 0

  /// pitch: looking down positive; up = (-sin roll cos pitch, -cos roll cos pitch, -sin pitch).
  static TableGeometry from_pitch_roll(double pitch_rad, double roll_rad, double camera_height_m);
  double pitch_rad() const;
  double roll_rad() const;
};

/// How well a TableGeometry is known: one standard deviation each.
struct TableUncertainty {
  double height_m = 0;  ///< of the camera's height above the plane
  double pitch_rad = 0;
  double roll_rad = 0;   ///< large where the camera looks straight down: roll has no meaning there
  double tilt_rad = 0;   ///< of the normal, in its worst direction
  double surface_m = 0;  ///< of the plane's height where it was seen, at its worst point
};

/// Tolerances of the table constraint (thesis table 6.3: 0.0135 m, 12 deg).
struct TableTolerance {
  double height_m = 0.0135;               ///< of the object's centre above the table
  double angle_rad = 0.2094395102393195;  ///< of rx and of ry
};

/// The tolerance for a table that is itself uncertain: wider by twice the surface's and the tilt's deviation.
TableTolerance widened(const TableTolerance& tolerance, const TableUncertainty& uncertainty);

/// What the table demands at one pixel.
struct UprightPose {
  double rx = 0;             ///< radians
  double ry = 0;             ///< radians
  double sine_of_elevation;  ///< of the ray below the horizon; <= 0: the ray never meets the table
};

/// rx, ry of an upright object whose centre projects to pixel (x, y), and the ray's sine of elevation.
UprightPose upright_pose_at(const PinholeCamera& camera, const Eigen::Vector3d& up_in_camera, double x,
                            double y);

/// CONSTRAINT-CONTAINS (Proc. 21, with the z test that the thesis forgot). centre_height_m: of the object's
/// centre above the table. z: |camera_height - centre_height - z * sine_of_elevation| <= tolerance.height_m.
bool table_constraint_contains(const PinholeCamera& camera, const TableGeometry& table,
                               double centre_height_m, const TableTolerance& tolerance, const Pose6& pose);

/// Ranges of what the table demands over a rectangle of pixel positions [x.lo, x.hi] x [y.lo, y.hi].
/// Every value at any point of the rectangle lies inside (RX-RANGE, RY-RANGE, Z-RANGE of Procs. 22-27 for
/// any gravity direction); sine_of_elevation is exact up to rounding, rx is an interval enclosure.
struct UprightRange {
  Interval rx;  ///< radians; [-pi, pi] where undefined
  Interval ry;  ///< radians
  Interval sine_of_elevation;
};
UprightRange upright_range_over(const PinholeCamera& camera, const Eigen::Vector3d& up_in_camera, Interval x,
                                Interval y);

/// Range of z (metres) of a centre at centre_height_m +- tolerance over rays of the given elevation sines.
/// Empty (lo > hi) where no ray meets the table.
Interval table_distance_range(const TableGeometry& table, double centre_height_m,
                              const TableTolerance& tolerance, Interval sine_of_elevation);

}  // namespace sextant
