// SPDX-License-Identifier: Apache-2.0
// Which of two poses of one mesh explains the depth image better, by the pixels in which they differ: where
// one shows the object (a mug's handle) and the other the table behind it.
#pragma once

#include <optional>

#include "runtime/frame/search_frame.h"
#include "runtime/geometry/table_geometry.h"
#include "runtime/refine/depth_raster.h"

namespace sextant {

/// How much better the second picture explains the measured depth than the first: from -1 to 1, the
/// difference of the shares of unexplained pixels among those in which they differ by more than a centimetre
/// and depth was measured; 0 where there are fewer than 30 of those. Without a table nothing is known beside
/// the object, and only pixels that show it in both pictures count.
double explained_better(const SearchFrame& frame, const std::optional<TableGeometry>& table,
                        const DepthRaster& first, const DepthRaster& second);

}  // namespace sextant
