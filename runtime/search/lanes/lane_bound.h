// SPDX-License-Identifier: Apache-2.0
// Lower bounds of the cost of 64 cells at once. The exact counterpart is `evaluate`: for every feasible pose
// p of a lane, units(lane) <= (offset - evaluate(p)) * units_per_score, up to what score_bound and
// budget_units allow for. Everything is rounded towards lower costs.
#pragma once

#include <array>
#include <cstdint>

#include "runtime/search/lanes/lane_bin.h"
#include "runtime/search/lanes/lane_node.h"
#include "runtime/search/lanes/lane_tile.h"
#include "runtime/tables/lane_tables.h"

namespace sextant {

/// What is the same for all nodes of one search.
struct LaneFrame {
  const LaneTables& tables;
  PinholeCamera camera;
  int nearest_index = 1, farthest_index = 1500;  ///< lattice steps of z that are allowed
};

/// Costs of all lanes, 65535 for those that are dead, and the mask of those within the budget.
struct LaneCosts {
  alignas(64) std::array<std::uint16_t, kLanes> units{};
  std::uint64_t alive = 0;
  std::uint32_t parts = 0;  ///< parts that were looked at before all lanes were dead
};

/// Bounds the lanes of node.alive; stops as soon as all of them cost more than the budget. Vector code chosen
/// for the CPU at run time.
void lane_bound(const LaneFrame& frame, const LaneBin& bin, const LaneTile& tile, const LaneNode& node,
                std::uint16_t budget, LaneCosts& out);

/// The plain twin: the same integers, one lane and one part after the other.
void lane_bound_plain(const LaneFrame& frame, const LaneBin& bin, const LaneTile& tile, const LaneNode& node,
                      std::uint16_t budget, LaneCosts& out);

}  // namespace sextant
