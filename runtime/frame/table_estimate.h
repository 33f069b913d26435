// SPDX-License-Identifier: Apache-2.0
// The table from one depth image: the plane that most of the depth agrees on (RANSAC with samples from one
// neighbourhood, Fischler & Bolles 1981; then weighted least squares on its inliers), with its uncertainty,
// or the reason why there is none.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <string>
#include <tl/expected.hpp>

#include "runtime/frame/table_points.h"
#include "runtime/geometry/table_geometry.h"

namespace sextant {

/// What is known before the image is looked at.
struct TableEstimateOptions {
  /// Unit vector against gravity in the camera frame, from an IMU or the robot. Without it the camera is
  /// taken to look down (5..90 deg) the right way up.
  std::optional<Eigen::Vector3d> up_in_camera{};
  double up_tolerance_rad = 0.26;  ///< how far the table's normal may be from up_in_camera
  double lowest_m = 0.05;          ///< camera above the table, metres
  double highest_m = 3.0;
  double least_share = 0.15;  ///< of the sampled depth pixels that must lie on the plane
};

struct TableEstimate {
  TableGeometry table;
  TableUncertainty uncertainty;
  double inlier_share = 0;  ///< of the sampled depth pixels, within the sensor's noise of the plane
  double residual_m = 0;    ///< their root mean square distance from it
};

/// The reason for a refusal, for people: what was seen, what to do.
struct NoTable {
  std::string reason;
};

/// Deterministic: the same points give the same plane. Refuses where fewer than 200 samples have depth, where
/// no plane gets least_share of them, and where a second plane parallel to the first but at another height
/// has at least 80 % of its support: options narrow that down. Of two parallel planes more than 0.3 m apart
/// the upper one is the table where it has a quarter of the depth; with less of it (but least_share), the
/// answer is doubtful and refused.
///
/// The uncertainty is that of the least squares fit with errors that are common to whole patches of the image
/// (sensor warp, correlated noise: the cluster-robust covariance of 8 x 6 patches), and of what a depth
/// camera's own calibration leaves, which no residual shows: 1 mm and 0.2 deg where the plane was seen. The
/// camera's height suffers from both: a tilt about a place half a metre away moves the point below the
/// camera.
tl::expected<TableEstimate, NoTable> estimate_table(const TablePoints& points,
                                                    const TableEstimateOptions& options = {});
tl::expected<TableEstimate, NoTable> estimate_table(const SearchFrame& frame,
                                                    const TableEstimateOptions& options = {});

}  // namespace sextant
