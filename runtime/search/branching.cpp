// SPDX-License-Identifier: Apache-2.0
#include "runtime/search/branching.h"

#include <algorithm>
#include <array>

namespace sextant {
namespace {

// Measured: rotations move pixels less than their coefficients say (parts differ in sign) and depths more.
constexpr double kRotationPixelWeight = 0.5;
constexpr double kRotationDepthWeight = 2.0;

}  // namespace

std::pair<Region, Region> halves(const ScoredBin& bin, double bounding_radius_m, double focal,
                                 const Region& region) {
  std::array<double, kDimensions> span{};
  for (std::size_t d = 0; d < kDimensions; ++d) span[d] = region.hi[d] - region.lo[d];
  const double z = 0.5 * (region.lo[kZ] + region.hi[kZ]) * kLatticeDistance;
  const double visual_radius = std::max(bin.mean_visual_radius, 1e-6);
  const double depth_radius = std::max(bin.mean_depth_radius, 1e-6);

  std::array<double, kDimensions> effect{};
  effect[kX] = span[kX] * z / focal / visual_radius;
  effect[kY] = span[kY] * z / focal / visual_radius;
  const double dz = span[kZ] * kLatticeDistance;
  effect[kZ] = std::max(bounding_radius_m * dz / z / visual_radius, dz / depth_radius);
  for (std::size_t a = 0; a < 3; ++a) {
    const double angle = span[kRx + a] * kLatticeAngle;
    effect[kRx + a] = angle * std::max(kRotationPixelWeight * bin.visual_effect[a],
                                       kRotationDepthWeight * bin.depth_effect[a]);
    // A model without parts of a kind still has to be divided.
    if (span[kRx + a] > 0 && effect[kRx + a] == 0) effect[kRx + a] = 1e-9 * span[kRx + a];
  }
  const auto widest =
      static_cast<std::size_t>(std::max_element(effect.begin(), effect.end()) - effect.begin());
  const auto middle = static_cast<std::int16_t>((region.lo[widest] + region.hi[widest]) >> 1);
  std::pair<Region, Region> parts{region, region};
  parts.first.hi[widest] = middle;
  parts.second.lo[widest] = static_cast<std::int16_t>(middle + 1);
  return parts;
}

}  // namespace sextant
