// SPDX-License-Identifier: Apache-2.0
#include "runtime/search/bound.h"

#include "runtime/search/part_arithmetic.h"

namespace sextant {
namespace {

/// The region in the score's coordinates.
struct FloatRegion {
  FloatRange x, y, z, rx, ry, rz;
  FloatRange scale;  ///< focal / z
  float unit2 = 0;   ///< (z / focal)^2 at the nearest z: a lower bound

  FloatRegion(const Region& r, float focal)
      : x{lattice_pixel(r.lo[kX]), lattice_pixel(r.hi[kX])},
        y{lattice_pixel(r.lo[kY]), lattice_pixel(r.hi[kY])},
        z{lattice_distance(r.lo[kZ]), lattice_distance(r.hi[kZ])},
        rx{lattice_angle(r.lo[kRx]), lattice_angle(r.hi[kRx])},
        ry{lattice_angle(r.lo[kRy]), lattice_angle(r.hi[kRy])},
        rz{lattice_angle(r.lo[kRz]), lattice_angle(r.hi[kRz])},
        scale{focal / z.hi, focal / z.lo} {
    const float unit = z.lo / focal;
    unit2 = unit * unit;
  }
};

/// Where a part can fall: the window that covers the rectangle.
struct Window {
  int level = 0;
  int index = 0;
};
Window window_of(IndexRange columns, IndexRange rows, int stride) {
  const int side = std::max(columns.hi - columns.lo, rows.hi - rows.lo) + 1;
  return {FrameTables::level_for(side), rows.lo * stride + columns.lo};
}

constexpr int kLevels = static_cast<int>(kWindowSides.size());

float lowest_visual_cost(const VisualParts& parts, std::size_t i, const FloatRegion& r,
                         const FrameTables& tables) {
  const FloatRange u = linear(parts.u[0][i], parts.u[1][i], parts.u[2][i], parts.u[3][i], r.rx, r.ry, r.rz);
  const FloatRange v = linear(parts.v[0][i], parts.v[1][i], parts.v[2][i], parts.v[3][i], r.rx, r.ry, r.rz);
  const IndexRange columns = table_index(r.x, r.scale, u, tables.width());
  const IndexRange rows = table_index(r.y, r.scale, v, tables.height());
  const Window w = window_of(columns, rows, tables.stride());
  if (w.level >= kLevels) return 0;
  const auto distance2 = static_cast<float>(tables.distance2(parts.kind[i], w.level)[w.index]);
  const float cost = std::min(distance2 * r.unit2, parts.radius2[i]) * parts.weight[i];
  const bool outside = is_outside(columns.lo, rows.lo, tables) || is_outside(columns.hi, rows.hi, tables);
  return outside ? std::min(cost, parts.outside_cost[i]) : cost;
}

float lowest_depth_cost(const DepthParts& parts, std::size_t i, const FloatRegion& r,
                        const FrameTables& tables) {
  const FloatRange px{parts.px[i], parts.px[i]};
  const FloatRange py{parts.py[i], parts.py[i]};
  const Window w = window_of(table_index(r.x, r.scale, px, tables.width()),
                             table_index(r.y, r.scale, py, tables.height()), tables.stride());
  if (w.level >= kLevels) return 0;
  const std::uint16_t nearest = tables.nearest_depth(w.level)[w.index];
  if (nearest == FrameTables::kMissing) return parts.missing_cost[i];
  const FloatRange offset =
      linear(parts.d[0][i], parts.d[1][i], parts.d[2][i], parts.d[3][i], r.rx, r.ry, r.rz);
  const FloatRange expected{r.z.lo + offset.lo, r.z.hi + offset.hi};
  const float near_m = static_cast<float>(nearest) * FrameTables::kDepthUnit;
  const float far_m = static_cast<float>(tables.farthest_depth(w.level)[w.index]) * FrameTables::kDepthUnit;
  const float behind = near_m - expected.hi;
  const float before = expected.lo - far_m;
  const float gap = std::max(0.0F, std::max(behind, before));
  const float cost =
      std::min(gap * gap, before > 0 ? parts.near_radius2[i] : parts.radius2[i]) * parts.weight[i];
  return tables.any_missing(w.level)[w.index] ? std::min(cost, parts.missing_cost[i]) : cost;
}

}  // namespace

double window_bound(const ScoredBin& bin, const FrameTables& tables, const Region& region, double floor) {
  const FloatRegion r(region, static_cast<float>(tables.camera().focal));
  const double budget = bin.offset - floor;
  double cost = 0;
  for (std::size_t i = 0; i < bin.visual.size(); ++i) {
    cost += static_cast<double>(lowest_visual_cost(bin.visual, i, r, tables));
    if (cost > budget) return bin.offset - cost;
  }
  for (std::size_t i = 0; i < bin.depth.size(); ++i) {
    cost += static_cast<double>(lowest_depth_cost(bin.depth, i, r, tables));
    if (cost > budget) return bin.offset - cost;
  }
  return bin.offset - cost;
}

}  // namespace sextant
