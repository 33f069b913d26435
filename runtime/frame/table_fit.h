// SPDX-License-Identifier: Apache-2.0
// A plane fitted to the samples near it, and how well that determines it.
#pragma once

#include <Eigen/Core>

#include "runtime/frame/table_points.h"
#include "runtime/geometry/table_geometry.h"

namespace sextant {

/// up . p + height = 0; up is a unit vector that points from the plane to the camera, height > 0.
struct TablePlane {
  Eigen::Vector3d up{0, 0, 0};
  double height = 0;

  /// Signed distance above the plane, metres.
  double above(const Eigen::Vector3d& p) const { return up.dot(p) + height; }
};

/// Standard deviation of a depth camera's distance at axial depth z, metres (measured on Kinect v1, Xtion and
/// RealSense: 1-2 mm at 0.7 m, growing with the square of the distance).
double depth_deviation(double z);

/// Is a sample on the plane? Within 2.5 deviations of the sensor, scaled by `slack`.
bool lies_on(const TablePlane& plane, const Eigen::Vector3d& p, double slack);

struct TableFit {
  TablePlane plane;
  int inliers = 0;
  double residual_m = 0;         ///< root mean square of the inliers
  TableUncertainty uncertainty;  ///< cluster-robust, with the calibration's share (estimate_table)
};

/// Repeats weighted least squares on the samples that lie on the plane so far, from `start`. Fewer than 50
/// inliers on the way: inliers is 0.
TableFit fit_table(const TablePoints& points, const TablePlane& start);

}  // namespace sextant
