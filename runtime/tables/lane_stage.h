// SPDX-License-Identifier: Apache-2.0
// Stages of the lane search. A lane is one square cell of the image; 16 x 4 neighbouring cells are bounded at
// once, one SIMD lane each, because the windows that one part needs for neighbouring cells lie beside each
// other in memory. The first stage has large cells, the last one single pixels.
#pragma once

#include <array>
#include <cstddef>

namespace sextant {

inline constexpr int kLaneColumns = 16;
inline constexpr int kLaneRows = 4;
inline constexpr int kLanes = kLaneColumns * kLaneRows;
inline constexpr std::size_t kLaneLevels = 8;

/// One stage: how large a cell is and which windows there are.
struct LaneStage {
  int cell;                              ///< side of a lane's cell, pixels
  int grain;                             ///< pixels between the origins of two windows; divides cell
  std::array<int, kLaneLevels> windows;  ///< sides of the windows, in grains, increasing

  int phases() const { return cell / grain; }
};

inline constexpr std::array<LaneStage, 3> kLaneStages{{
    {8, 2, {5, 6, 8, 12, 16, 24, 32, 48}},
    {4, 2, {3, 4, 5, 6, 8, 12, 16, 24}},
    {1, 1, {1, 2, 3, 4, 6, 8, 12, 16}},
}};

}  // namespace sextant
