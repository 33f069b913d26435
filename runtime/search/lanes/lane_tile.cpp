// SPDX-License-Identifier: Apache-2.0
#include "runtime/search/lanes/lane_tile.h"

#include <algorithm>
#include <cmath>

namespace sextant {
namespace {

constexpr int kNearest = -2000;  ///< clamps of anchors: beyond every distance that a lattice index can hold
constexpr int kFarthest = 31000;

int clamped(double value) { return static_cast<int>(std::clamp<double>(value, kNearest, kFarthest)); }

}  // namespace

int anchor_distance(const Constraint& constraint, int x, int y) {
  return clamped(std::floor(constraint.table_distance(x, y) / kLatticeDistance));
}

LaneTile lane_tile(const Constraint& constraint, int stage, int x0, int y0) {
  LaneTile tile;
  tile.stage = stage;
  tile.x0 = x0;
  tile.y0 = y0;
  const int cell = kLaneStages[static_cast<std::size_t>(stage)].cell;
  tile.row_anchor_lo.fill(kFarthest);
  tile.row_anchor_hi.fill(kNearest);
  bool first = true;
  // Single pixels share one range of rotations and offsets: over so few it hardly differs.
  const CellRange all =
      cell == 1 ? constraint.over_cell(x0, y0, x0 + kLaneColumns - 1, y0 + kLaneRows - 1) : CellRange{};
  for (int lane = 0; lane < kLanes; ++lane) {
    const auto i = static_cast<std::size_t>(lane);
    const int x = x0 + lane % kLaneColumns * cell;
    const int y = y0 + lane / kLaneColumns * cell;
    const CellRange range = cell == 1 ? all : constraint.over_cell(x, y, x + cell - 1, y + cell - 1);
    if (range.empty() || x >= constraint.camera().width || y >= constraint.camera().height) continue;
    tile.feasible |= std::uint64_t{1} << lane;
    // A single pixel's anchor is one number, the same wherever it is computed; a cell's holds those of its
    // pixels.
    const int lo = cell == 1 ? anchor_distance(constraint, x, y)
                             : clamped(std::floor(range.table_distance.lo / kLatticeDistance - 1e-6));
    const int hi = cell == 1 ? lo : clamped(std::floor(range.table_distance.hi / kLatticeDistance + 1e-6));
    tile.anchor_lo[i] = static_cast<std::int16_t>(lo);
    tile.anchor_hi[i] = static_cast<std::int16_t>(hi);
    tile.rx_lo[i] = range.rx_lo;
    tile.rx_hi[i] = range.rx_hi;
    tile.ry_lo[i] = range.ry_lo;
    tile.ry_hi[i] = range.ry_hi;
    auto& row_lo = tile.row_anchor_lo[i / kLaneColumns];
    auto& row_hi = tile.row_anchor_hi[i / kLaneColumns];
    row_lo = std::min(row_lo, lo);
    row_hi = std::max(row_hi, hi);
    tile.offset_lo = first ? range.offset_lo : std::min<int>(tile.offset_lo, range.offset_lo);
    tile.offset_hi = first ? range.offset_hi : std::max<int>(tile.offset_hi, range.offset_hi);
    tile.rx_min = first ? range.rx_lo : std::min<int>(tile.rx_min, range.rx_lo);
    tile.rx_max = first ? range.rx_hi : std::max<int>(tile.rx_max, range.rx_hi);
    tile.ry_min = first ? range.ry_lo : std::min<int>(tile.ry_min, range.ry_lo);
    tile.ry_max = first ? range.ry_hi : std::max<int>(tile.ry_max, range.ry_hi);
    first = false;
  }
  return tile;
}

}  // namespace sextant
