// SPDX-License-Identifier: Apache-2.0
#include "runtime/search/reference/thesis_bound.h"

#include <algorithm>
#include <cmath>

#include "runtime/search/part_arithmetic.h"

namespace sextant {
namespace {

constexpr std::int64_t kBruteForceArea = 500;  ///< Proc. 18, line 13

/// Pixels of floor(lo)..ceil(hi), kept within a frame's width of the image so that integers never overflow.
struct Span {
  int lo, hi;
};
Span pixels(float lo, float hi, int limit) {
  const auto clamp = [&](float v) {
    return std::clamp(v, -static_cast<float>(limit), 2 * static_cast<float>(limit));
  };
  return {static_cast<int>(std::floor(clamp(lo))), static_cast<int>(std::ceil(clamp(hi)))};
}

/// The rectangle in which a part at tangent offset (u, v) can project (Procs. 16, 18, lines 4-9).
PixelRect projected(const Region& r, const FrameTables& tables, FloatRange u, FloatRange v) {
  const auto focal = static_cast<float>(tables.camera().focal);
  const float near_scale = focal / lattice_distance(r.lo[kZ]);
  const float far_scale = focal / lattice_distance(r.hi[kZ]);
  const Span x =
      pixels(lattice_pixel(r.lo[kX]) + std::min(near_scale * u.lo, far_scale * u.lo),
             lattice_pixel(r.hi[kX]) + std::max(near_scale * u.hi, far_scale * u.hi), tables.width());
  const Span y =
      pixels(lattice_pixel(r.lo[kY]) + std::min(near_scale * v.lo, far_scale * v.lo),
             lattice_pixel(r.hi[kY]) + std::max(near_scale * v.hi, far_scale * v.hi), tables.height());
  return {x.lo, x.hi, y.lo, y.hi};
}

FloatRange angle_range(const Region& r, Dimension d) {
  return {lattice_angle(r.lo[d]), lattice_angle(r.hi[d])};
}

FloatRange part_range(const std::array<std::vector<float>, 4>& c, std::size_t i, const Region& r) {
  return linear(c[0][i], c[1][i], c[2][i], c[3][i], angle_range(r, kRx), angle_range(r, kRy),
                angle_range(r, kRz));
}

/// BOUND-VISUAL (Proc. 16), as a cost.
float visual_cost(const VisualParts& parts, std::size_t i, const ThesisTables& tables, const Region& region) {
  PixelRect r =
      projected(region, tables.frame(), part_range(parts.u, i, region), part_range(parts.v, i, region));
  const bool outside =
      r.x0 < 0 || r.y0 < 0 || r.x1 >= tables.frame().width() || r.y1 >= tables.frame().height();
  const auto focal = static_cast<float>(tables.frame().camera().focal);
  const int reach =
      static_cast<int>(std::ceil(std::sqrt(parts.radius2[i]) * focal / lattice_distance(region.lo[kZ]))) + 1;
  r = {r.x0 - reach, r.x1 + reach, r.y0 - reach, r.y1 + reach};
  if (tables.features(parts.kind[i], r) > 0) return 0;
  const float miss = parts.radius2[i] * parts.weight[i];
  return outside ? std::min(miss, parts.outside_cost[i]) : miss;
}

/// BRUTE-FORCE-BOUND-DEPTH (Proc. 17), as a cost.
float brute_force_depth_cost(const DepthParts& parts, std::size_t i, const FrameTables& tables,
                             const PixelRect& r, FloatRange expected) {
  float cost = parts.radius2[i] * parts.weight[i];
  const std::uint16_t* depth = tables.nearest_depth(0);
  for (int y = r.y0; y <= r.y1; ++y) {
    for (int x = r.x0; x <= r.x1; ++x) {
      const std::uint16_t steps = depth[tables.clamp_y(y) * tables.stride() + tables.clamp_x(x)];
      if (steps == FrameTables::kMissing) {
        cost = std::min(cost, parts.missing_cost[i]);
        continue;
      }
      const float d = static_cast<float>(steps) * FrameTables::kDepthUnit;
      const float gap = std::max(0.0F, std::max(d - expected.hi, expected.lo - d));
      const float radius2 = expected.lo > d ? parts.near_radius2[i] : parts.radius2[i];
      cost = std::min(cost, std::min(gap * gap, radius2) * parts.weight[i]);
    }
  }
  return cost;
}

/// BOUND-DEPTH (Proc. 18), as a cost.
float depth_cost(const DepthParts& parts, std::size_t i, const ThesisTables& tables, const Region& region) {
  const PixelRect r =
      projected(region, tables.frame(), {parts.px[i], parts.px[i]}, {parts.py[i], parts.py[i]});
  const FloatRange offset = part_range(parts.d, i, region);
  const FloatRange expected{lattice_distance(region.lo[kZ]) + offset.lo,
                            lattice_distance(region.hi[kZ]) + offset.hi};
  const std::int64_t area = static_cast<std::int64_t>(r.x1 - r.x0 + 1) * (r.y1 - r.y0 + 1);
  if (area < kBruteForceArea) return brute_force_depth_cost(parts, i, tables.frame(), r, expected);
  const float reach = std::sqrt(parts.radius2[i]) + FrameTables::kDepthUnit;
  if (tables.depths(r, expected.lo - reach, expected.hi + reach) > 0) return 0;
  const bool outside =
      r.x0 < 0 || r.y0 < 0 || r.x1 >= tables.frame().width() || r.y1 >= tables.frame().height();
  // The sums do not say on which side the depths lie.
  const float worst = std::min(parts.radius2[i], parts.near_radius2[i]) * parts.weight[i];
  return outside || tables.missing(r) > 0 ? std::min(worst, parts.missing_cost[i]) : worst;
}

}  // namespace

double thesis_bound(const ScoredBin& bin, const ThesisTables& tables, const Region& region) {
  double cost = 0;
  for (std::size_t i = 0; i < bin.visual.size(); ++i) {
    cost += static_cast<double>(visual_cost(bin.visual, i, tables, region));
  }
  for (std::size_t i = 0; i < bin.depth.size(); ++i) {
    cost += static_cast<double>(depth_cost(bin.depth, i, tables, region));
  }
  return bin.offset - cost;
}

}  // namespace sextant
