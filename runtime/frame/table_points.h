// SPDX-License-Identifier: Apache-2.0
// A thinned grid of the depth image's points in the camera frame: what table estimation works on.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "runtime/frame/rgbd_frame.h"
#include "runtime/frame/search_frame.h"

namespace sextant {

/// Points by grid cell, row by row; a cell without depth holds (0, 0, 0).
struct TablePoints {
  int columns = 0;
  int rows = 0;
  std::vector<Eigen::Vector3f> points;  ///< columns * rows, metres

  const Eigen::Vector3f& at(int column, int row) const {
    return points[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
                  static_cast<std::size_t>(column)];
  }
};

/// Every n-th pixel of a row and column, n = max(1, width / 160). Farther than `farthest_m` (axial) counts as
/// missing: depth is too coarse there to help.
TablePoints table_points(const SearchFrame& frame, double farthest_m = 2.5);
/// The same from a frame that is not rectified: lens distortion and fx != fy are undone for the samples.
/// Throws InputError for a frame whose depth does not match its calibration.
TablePoints table_points(const RgbdFrame& frame, double farthest_m = 2.5);

}  // namespace sextant
