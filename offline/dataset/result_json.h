// SPDX-License-Identifier: Apache-2.0
// One frame's answer as one line of JSON: the machine-readable output of `sextant detect --json`.
#pragma once

#include <string>

#include "runtime/refine/frame_result.h"

namespace sextant {

/// A JSON object on one line, without line end. Keys: scene_id, im_id, seconds {features, tables, search,
/// refine, total}, nodes, objects [{obj_id, status, upper_bound, coverage}], detections [{obj_id, score,
/// log_score, upper_bound, gap, status, camera_from_object (4 rows of 4, metres, mesh's own frame), bbox [x,
/// y, w, h]}]. Numbers that are not finite become null.
std::string format_result_json(const FrameResult& result);

}  // namespace sextant
