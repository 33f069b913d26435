// SPDX-License-Identifier: Apache-2.0
// An evaluation as people and programs read it: text table, JSON line, self-contained HTML page.
#pragma once

#include <string>

#include "offline/evaluate/evaluation.h"

namespace sextant {

/// A table, one line per object and one for all, with line ends.
std::string format_report_text(const EvaluationReport& report);

/// One JSON object without line end: "images", "seconds", "total" and "objects" (by id) with "instances",
/// "found", "right", "detections", "share_right", "share_translation", "share_rotation",
/// "median_translation_cm", "median_rotation_deg", "precision", "recall", "average_precision", "add_recall",
/// "false_images", "false_detections", and "instances" [{scene_id, im_id, obj_id, found, right, score,
/// translation_cm, rotation_deg, add_mm, add_s_mm}].
std::string format_report_json(const EvaluationReport& report);

/// An HTML page that needs no other file: the table, curves of the errors, the worst instances.
std::string format_report_html(const EvaluationReport& report, const std::string& title);

}  // namespace sextant
