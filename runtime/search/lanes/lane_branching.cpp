// SPDX-License-Identifier: Apache-2.0
#include "runtime/search/lanes/lane_branching.h"

#include <algorithm>
#include <array>

#include "runtime/search/lattice.h"
#include "runtime/tables/lane_stage.h"

namespace sextant {
namespace {

// Measured by nodes on the bundled sample. Rotations move pixels less than their coefficients say (parts
// differ in sign). Smaller cells cost nothing but lanes that would be empty otherwise: they go first.
constexpr double kRotationPixelWeight = 0.5;
constexpr double kCellWeight = 4.0;

}  // namespace

LaneSplit lane_split(const LaneNode& node, const ScoredBin& bin, double bounding_radius_m, double focal,
                     double z_m) {
  const double visual_radius = std::max(bin.mean_visual_radius, 1e-6);
  const double depth_radius = std::max(bin.mean_depth_radius, 1e-6);
  const double dz = (node.offset_hi - node.offset_lo) * kLatticeDistance;
  std::array<double, 5> effect{};
  effect[0] = std::max(bounding_radius_m * dz / z_m / visual_radius, dz / depth_radius);
  for (std::size_t a = 0; a < 3; ++a) {
    const double angle = (node.hi[a] - node.lo[a]) * kLatticeAngle;
    effect[1 + a] = angle * std::max(kRotationPixelWeight * bin.visual_effect[a], bin.depth_effect[a]);
    // A model without parts of a kind still has to be divided.
    if (angle > 0 && effect[1 + a] == 0) effect[1 + a] = 1e-9 * angle;
  }
  const int cell = kLaneStages[node.stage].cell;
  // Smaller cells: also where nothing else is left to divide.
  effect[4] = cell > 1 ? std::max(kCellWeight * (cell - 1) * z_m / focal / visual_radius, 1e-12) : -1;
  return static_cast<LaneSplit>(std::max_element(effect.begin(), effect.end()) - effect.begin());
}

LaneHalves lane_halves(const LaneNode& node, LaneSplit split) {
  LaneHalves out{node, node};
  const auto cut = [](std::int16_t lo, std::int16_t hi) { return static_cast<std::int16_t>((lo + hi) >> 1); };
  if (split == LaneSplit::kOffset) {
    out.first.offset_hi = cut(node.offset_lo, node.offset_hi);
    out.second.offset_lo = static_cast<std::int16_t>(out.first.offset_hi + 1);
  } else {
    const auto a = static_cast<std::size_t>(split) - static_cast<std::size_t>(LaneSplit::kRx);
    out.first.hi[a] = cut(node.lo[a], node.hi[a]);
    out.second.lo[a] = static_cast<std::int16_t>(out.first.hi[a] + 1);
  }
  return out;
}

std::uint64_t lanes_of_child(const LaneNode& node, int x0, int y0) {
  const int cell = kLaneStages[node.stage].cell;
  const int child_cell = kLaneStages[node.stage + std::size_t{1}].cell;
  std::uint64_t lanes = 0;
  for (int row = 0; row < kLaneRows; ++row) {
    const int parent_row = (y0 + row * child_cell - node.y0) / cell;
    const auto alive = static_cast<unsigned>(node.alive >> (parent_row * kLaneColumns)) & 0xFFFFU;
    if (alive == 0) continue;
    for (int column = 0; column < kLaneColumns; ++column) {
      const int parent_column = (x0 + column * child_cell - node.x0) / cell;
      if ((alive >> parent_column) & 1U) lanes |= std::uint64_t{1} << (row * kLaneColumns + column);
    }
  }
  return lanes;
}

}  // namespace sextant
