// SPDX-License-Identifier: Apache-2.0
// What both twins of the lane bound compute once per node: rotations as floats, each lane's distances, the
// range of scales.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "runtime/search/lanes/lane_bound.h"

namespace sextant {

struct LaneNodeFrame {
  static constexpr float kPixelSlack = 2e-3F;  ///< pixels that float rounding may move a part
  static constexpr float kDepthSlack = 0.05F;  ///< depth steps
  /// Depth steps in a lattice step of z.
  static constexpr int kStepsPerIndex =
      static_cast<int>(kLatticeDistance / double{FrameTables::kDepthUnit} + 0.5);
  /// z from here on may not fit into 16 bits of depth steps.
  static constexpr int kFarIndex = 64000 / kStepsPerIndex;

  std::array<float, 3> middle{}, half{};  ///< rx, ry, rz, radians
  float scale_lo = 0, scale_hi = 0;       ///< pixels per (tangent * metre)
  float codes = 0;                        ///< codes of distance per (tangent * metre) at the nearest z
  bool far = false;                       ///< some lane's distance does not fit: no upper end
  std::uint64_t alive = 0;
  alignas(64) std::array<std::uint16_t, kLanes> z_lo{}, z_hi{};  ///< depth steps

  LaneNodeFrame(const LaneFrame& frame, const LaneTile& tile, const LaneNode& node) {
    for (std::size_t a = 0; a < 3; ++a) {
      middle[a] = static_cast<float>(0.5 * (node.lo[a] + node.hi[a]) * kLatticeAngle);
      half[a] = static_cast<float>(0.5 * (node.hi[a] - node.lo[a]) * kLatticeAngle * (1 + 1e-6));
    }
    int nearest = frame.farthest_index;
    int farthest = frame.nearest_index;
    std::uint64_t left = node.alive & tile.feasible;
    for (int lane = 0; lane < kLanes; ++lane) {
      const auto i = static_cast<std::size_t>(lane);
      const int lo = std::max(tile.anchor_lo[i] + node.offset_lo, frame.nearest_index);
      const int hi = std::min(tile.anchor_hi[i] + node.offset_hi, frame.farthest_index);
      z_lo[i] = static_cast<std::uint16_t>(std::clamp(lo * kStepsPerIndex, 0, 65535));
      z_hi[i] = static_cast<std::uint16_t>(std::clamp(hi * kStepsPerIndex, 0, 65535));
      const bool in_reach = lo <= hi && node.lo[0] <= tile.rx_hi[i] && node.hi[0] >= tile.rx_lo[i] &&
                            node.lo[1] <= tile.ry_hi[i] && node.hi[1] >= tile.ry_lo[i];
      left &= ~(std::uint64_t{!in_reach} << lane);
    }
    alive = left;
    for (int row = 0; row < kLaneRows; ++row) {
      const auto r = static_cast<std::size_t>(row);
      if (((left >> (row * kLaneColumns)) & 0xFFFFU) == 0) continue;
      nearest = std::min(nearest, std::max(tile.row_anchor_lo[r] + node.offset_lo, frame.nearest_index));
      farthest = std::max(farthest, std::min(tile.row_anchor_hi[r] + node.offset_hi, frame.farthest_index));
    }
    if (alive == 0) return;
    far = farthest > kFarIndex;
    const double z_near = nearest * kLatticeDistance;
    const double z_far = farthest * kLatticeDistance;
    scale_lo = static_cast<float>(frame.camera.focal / z_far * (1 - 1e-6));
    scale_hi = static_cast<float>(frame.camera.focal / z_near * (1 + 1e-6));
    codes = scale_hi * static_cast<float>(frame.tables.code_scale());
  }
};

}  // namespace sextant
