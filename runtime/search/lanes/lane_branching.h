// SPDX-License-Identifier: Apache-2.0
// How a lane node is divided: only the dimension with the largest effect on where the parts fall and what
// depth they expect (see branching.h); the image by going from cells to the next stage's smaller cells.
#pragma once

#include "runtime/search/lanes/lane_node.h"
#include "runtime/search/scored_bin.h"

namespace sextant {

/// A dimension of a lane node, or the next stage.
enum class LaneSplit { kOffset, kRx, kRy, kRz, kStage };

/// The dimension to divide. z_m: metres to about the middle of the node. The node is not single in the last
/// stage.
LaneSplit lane_split(const LaneNode& node, const ScoredBin& bin, double bounding_radius_m, double focal,
                     double z_m);

/// The halves of a node in a dimension other than the stage.
struct LaneHalves {
  LaneNode first, second;
};
LaneHalves lane_halves(const LaneNode& node, LaneSplit split);

/// The lanes of the tile (stage + 1, x0, y0) that lie in cells of `node` that are alive.
std::uint64_t lanes_of_child(const LaneNode& node, int x0, int y0);

}  // namespace sextant
