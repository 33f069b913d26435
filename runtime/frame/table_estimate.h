// SPDX-License-Identifier: Apache-2.0
// The table from one depth image: the largest plane below the camera (RANSAC, Fischler & Bolles 1981, then
// least squares on its inliers).
#pragma once

#include <optional>

#include "runtime/frame/search_frame.h"
#include "runtime/geometry/table_geometry.h"

namespace sextant {

struct TableEstimate {
  TableGeometry table;
  double inlier_share = 0;  ///< of the sampled depth pixels, within the inlier distance of the plane
};

/// Searches planes whose normal points at the camera and has an elevation of 5..90 deg (the camera looks down
/// on it). Deterministic: the same image gives the same plane. Empty where fewer than 200 pixels or less than
/// 15 % of the pixels agree on one plane.
std::optional<TableEstimate> estimate_table(const SearchFrame& frame);

}  // namespace sextant
