// SPDX-License-Identifier: Apache-2.0
// More places may be searched and refined than are reported (DetectOptions::candidates): what the score likes
// best is not always what the rigid model explains best. Of each object the answers with the highest
// confidence remain; their certificates say by how much the score prefers what was dropped.
#pragma once

#include <cstddef>
#include <vector>

#include "runtime/refine/frame_result.h"

namespace sextant {

/// Indices of the estimates that remain, in their order: at most `most` for each object. found: the score of
/// the lattice pose behind each estimate, which may have been turned since and score less. object_of: by
/// PoseEstimate::model_index. Bounds, gaps, margins and statuses in `estimates` then speak of the dropped
/// ones, too.
std::vector<std::size_t> keep_most_certain(std::vector<PoseEstimate>& estimates,
                                           const std::vector<double>& found,
                                           const std::vector<std::size_t>& object_of, int most);

}  // namespace sextant
