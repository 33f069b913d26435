// SPDX-License-Identifier: Apache-2.0
// The parts of one bin as the lane bound wants them: costs in whole units (16 bits), blocks of 16 parts,
// those that rule out most first.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "runtime/search/scored_bin.h"

namespace sextant {

inline constexpr std::size_t kPartBlock = 16;

/// 16 visual parts. u, v: coefficients of 1, rx, ry, rz, tangent * metre.
struct VisualBlock {
  alignas(64) std::array<std::array<float, kPartBlock>, 4> u{}, v{};
  alignas(64) std::array<std::int32_t, kPartBlock> kind{};
  alignas(64) std::array<float, kPartBlock> radius{};  ///< receptive field, tangent * metre
  std::array<std::uint16_t, kPartBlock> most{};        ///< cost at the radius and beyond, units
  std::array<std::uint16_t, kPartBlock> outside{};     ///< cost outside of the image, units, <= most
};

/// 16 depth parts.
struct DepthBlock {
  alignas(64) std::array<float, kPartBlock> px{}, py{};  ///< tangent * metre
  alignas(
      64) std::array<std::array<float, kPartBlock>, 4> d{};  ///< coefficients of 1, rx, ry, rz; depth steps
  std::array<std::uint16_t, kPartBlock> reach{};             ///< receptive field, depth steps
  std::array<std::uint16_t, kPartBlock> near_reach{};  ///< the same for depth nearer than expected, <= reach
  std::array<std::uint16_t, kPartBlock> gain{};        ///< 65535 / reach
  std::array<std::uint16_t, kPartBlock> most{};        ///< cost at the reach, units
  std::array<std::uint16_t, kPartBlock> missing{};     ///< cost where depth is missing, units
};

struct LaneBin {
  RotationBox box;
  std::vector<VisualBlock> visual;
  std::vector<DepthBlock> depth;
  /// The order of the blocks: index into `visual`, or into `depth` after them.
  std::vector<std::uint16_t> order;
  double offset = 0;           ///< score without costs
  double units_per_score = 0;  ///< 0: no pose of this bin can reach the floor
  double largest_depth = 0;    ///< metres from the object's centre
};

/// Prepares a bin for scores from `floor` up: offset - floor is 60,000 units. Costs are rounded down.
LaneBin lane_bin(const ScoredBin& bin, double floor);

/// The units that a pose may cost and still score at least `score`, with room for what rounding may take.
std::uint16_t budget_units(const LaneBin& bin, double score);
/// An upper bound of the score of poses whose units are at least `units`.
double score_bound(const LaneBin& bin, std::uint16_t units);

}  // namespace sextant
