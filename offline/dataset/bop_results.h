// SPDX-License-Identifier: Apache-2.0
// Pose results as the BOP challenge exchanges them: CSV with scene_id,im_id,obj_id,score,R,t,time.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "runtime/refine/frame_result.h"

namespace sextant {

/// One row.
struct BopResult {
  int scene_id = 0;
  int image_id = 0;
  int object_id = 0;
  double score = 0;
  RigidTransform camera_from_mesh = RigidTransform::Identity();  ///< mesh's own frame, metres
  double seconds = -1;  ///< of the whole image, equal for all its rows; -1: unknown
};

inline constexpr const char* kBopResultsHeader = "scene_id,im_id,obj_id,score,R,t,time";

/// The row as text, without line end: R row-wise, t in mm, shortest digits that read back exactly.
std::string format_bop_result(const BopResult& result);
/// One row per estimate, in its order; seconds are the frame's total.
std::vector<BopResult> bop_results_of(const FrameResult& result);

/// Throws InputError(file) where it cannot be written.
void write_bop_results(const std::filesystem::path& file, const std::vector<BopResult>& results);
/// Throws InputError naming file and line. The header may be missing.
std::vector<BopResult> read_bop_results(const std::filesystem::path& file);

}  // namespace sextant
