// SPDX-License-Identifier: Apache-2.0
#include "runtime/search/suppression.h"

#include <algorithm>

namespace sextant {
namespace {

double overlap(const Box2& a, const Box2& b) {
  const double w = std::min(a.x1, b.x1) - std::max(a.x0, b.x0);
  const double h = std::min(a.y1, b.y1) - std::max(a.y0, b.y0);
  return w > 0 && h > 0 ? w * h : 0;
}

}  // namespace

Box2 box_of(const ScoredBin& bin, double focal, const LatticePose& pose) {
  const double scale = focal / (pose.at[kZ] * kLatticeDistance);
  const double x = pose.at[kX];
  const double y = pose.at[kY];
  return {x + scale * bin.extent[0], y + scale * bin.extent[1], x + scale * bin.extent[2],
          y + scale * bin.extent[3]};
}

double intersection_over_union(const Box2& a, const Box2& b) {
  const double common = overlap(a, b);
  const double all = a.area() + b.area() - common;
  return all > 0 ? common / all : 0;
}

bool suppressed_everywhere(const ScoredBin& bin, double focal, const Region& region, const Box2& detection) {
  const double small = focal / (region.hi[kZ] * kLatticeDistance);
  const double large = focal / (region.lo[kZ] * kLatticeDistance);
  const auto lowest = [&](double offset) { return std::min(small * offset, large * offset); };
  const auto highest = [&](double offset) { return std::max(small * offset, large * offset); };
  // What every box of the region contains, and the largest that one can be.
  const Box2 common{region.hi[kX] + highest(bin.extent[0]), region.hi[kY] + highest(bin.extent[1]),
                    region.lo[kX] + lowest(bin.extent[2]), region.lo[kY] + lowest(bin.extent[3])};
  if (common.x0 >= common.x1 || common.y0 >= common.y1) return false;
  const double largest_area =
      large * large * (bin.extent[2] - bin.extent[0]) * static_cast<double>(bin.extent[3] - bin.extent[1]);
  const double shared = overlap(common, detection);
  const double all = largest_area + detection.area() - shared;
  return all > 0 && shared / all > kSuppressionIou;
}

}  // namespace sextant
