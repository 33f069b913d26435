// SPDX-License-Identifier: Apache-2.0
// Non-maximum suppression (Davies 2015, Proc. 34) as part of the search: a pose is suppressed by a better
// detection of the same object when their 2D boxes overlap with IoU > 0.5. A region in which every pose is
// suppressed need not be searched, which is what makes the second instance cheap.
#pragma once

#include <array>

#include "runtime/search/lattice.h"
#include "runtime/search/scored_bin.h"

namespace sextant {

/// Axis-aligned box in pixels.
struct Box2 {
  double x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  double area() const { return (x1 - x0) * (y1 - y0); }
};

inline constexpr double kSuppressionIou = 0.5;

/// 2D box of a pose: the bin's extent scaled by focal / z around (x, y).
Box2 box_of(const ScoredBin& bin, double focal, const LatticePose& pose);

double intersection_over_union(const Box2& a, const Box2& b);

/// True only if every pose of the region has IoU > 0.5 with `detection`.
bool suppressed_everywhere(const ScoredBin& bin, double focal, const Region& region, const Box2& detection);

}  // namespace sextant
