// SPDX-License-Identifier: Apache-2.0
// The table just where the object stands. A pose is refined against the same depth image that shows the
// table, so the table's height there says more than a plane that was fitted to the whole image or measured
// by hand: what a sensor's slow warp adds to both cancels.
#pragma once

#include "runtime/frame/search_frame.h"
#include "runtime/geometry/table_geometry.h"
#include "runtime/refine/depth_raster.h"

namespace sextant {

/// A table plane and how well it is known at one place.
struct LocalTable {
  TableGeometry table;
  double height_sigma_m = 0;  ///< of the plane under the object
  double tilt_sigma_rad = 0;  ///< about either horizontal axis
  bool fitted = false;        ///< false: the stated table with the stated tolerance
};

/// Fits the plane to the depth around the object (`object`: its picture, which is left out), robustly, within
/// twice the tolerance of the stated table. Where fewer than 150 samples agree, the stated table comes back
/// with half its tolerance as sigma. `centre`: of the object, camera frame, metres. Deterministic.
LocalTable local_table(const SearchFrame& frame, const TableGeometry& stated, const TableTolerance& tolerance,
                       const DepthRaster& object, const Eigen::Vector3d& centre);

}  // namespace sextant
