// SPDX-License-Identifier: Apache-2.0
// An evaluation as people and programs read it: text table and JSON line
// (the HTML page is in offline/report/html).
#pragma once

#include <string>

#include "offline/evaluate/evaluation.h"

namespace sextant {

/// A table, one line per object and one for all, with line ends.
std::string format_report_text(const EvaluationReport& report);

/// One JSON object without line end: "images", "seconds", "total" and "objects" (by id) with "instances",
/// "found", "right", "detections", "share_right", "share_translation", "share_rotation",
/// "median_translation_cm", "median_rotation_deg", "precision", "recall", "average_precision", "add_recall",
/// "false_images", "false_detections", "share_strict", "ar_mssd", "ar_mspd", "ar_vsd", "average_recall",
/// "calibration_error", "sure" (answers above 0.95), "share_sure_right", and "instances" [{scene_id, im_id,
/// obj_id, found, right, strict, score, translation_cm, rotation_deg, add_mm, add_s_mm, mssd_mm, mspd_px,
/// turntable_deg, visible}], "confusion"
/// {"images", "anywhere", "inside"} by object id.
std::string format_report_json(const EvaluationReport& report);

}  // namespace sextant
