// SPDX-License-Identifier: Apache-2.0
// A node of the lane search: up to 64 cells of the image with one box of distances and rotations.
#pragma once

#include <array>
#include <cstdint>

namespace sextant {

/// Closed ranges in lattice steps. offset: of z from the anchor of the pose's own pixel (see LaneTile). Plain
/// data: a node can be sent to another machine that searches the same frame for the same objects.
struct LaneNode {
  std::uint64_t alive = 0;      ///< lanes that may still hold a pose worth finding
  float bound = 0;              ///< no pose of these lanes scores higher
  std::int32_t bin = 0;         ///< among the bins of all objects
  std::int16_t x0 = 0, y0 = 0;  ///< first pixel of lane 0: names the tile
  std::int16_t offset_lo = 0, offset_hi = -1;
  std::array<std::int16_t, 3> lo{}, hi{};  ///< rx, ry, rz
  std::uint8_t stage = 0;

  /// One distance and one rotation per lane.
  bool single() const { return offset_lo == offset_hi && lo == hi; }
};

}  // namespace sextant
