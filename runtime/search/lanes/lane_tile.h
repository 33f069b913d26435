// SPDX-License-Identifier: Apache-2.0
// What is feasible in the 64 cells that are bounded together: every lane's range of rx and ry, and its
// distances as offsets from the table's own distance there. With the table under them, neighbouring cells
// share one narrow range of offsets although their distances differ.
#pragma once

#include <array>
#include <cstdint>

#include "runtime/search/constraint.h"
#include "runtime/tables/lane_stage.h"

namespace sextant {

/// Distance of the table's surface of centres at one pixel, lattice steps rounded down; 0 without a table or
/// where the ray does not meet it. A pose's offset is its z index minus this.
int anchor_distance(const Constraint& constraint, int x, int y);

/// Ranges are closed and in lattice steps; conservative where a lane is more than one pixel.
struct LaneTile {
  int stage = 0;
  int x0 = 0, y0 = 0;  ///< first pixel of lane 0
  std::uint64_t feasible = 0;
  alignas(64) std::array<std::int16_t, kLanes> anchor_lo{}, anchor_hi{};
  alignas(64) std::array<std::int16_t, kLanes> rx_lo{}, rx_hi{}, ry_lo{}, ry_hi{};
  /// Hulls over the feasible lanes.
  int offset_lo = 0, offset_hi = -1, rx_min = 0, rx_max = -1, ry_min = 0, ry_max = -1;
  std::array<int, kLaneRows> row_anchor_lo{}, row_anchor_hi{};
};

LaneTile lane_tile(const Constraint& constraint, int stage, int x0, int y0);

}  // namespace sextant
