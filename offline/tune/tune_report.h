// SPDX-License-Identifier: Apache-2.0
// What a tuning run found: text, JSON line, a page with a plot per parameter (the thesis's figures 6-1 ..
// 6-12) and a parameter file for `sextant compile --params`.
#pragma once

#include <string>

#include "offline/tune/tuning.h"

namespace sextant {

std::string format_tune_text(const TuneRun& run, const TuneResult& result);
/// One JSON object without line end: "metric", "points" [{parameters, images, instances, average_precision,
/// share_right, share_strict, seconds}] (training half), "best" (index), "parameters" (of the best),
/// "held_out" {"defaults", "best"}.
std::string format_tune_json(const TuneRun& run, const TuneResult& result);
std::string format_tune_html(const TuneRun& run, const TuneResult& result, const std::string& title);
/// The learning parameters of the best point as YAML; what belongs to detection as a comment.
std::string format_tuned_yaml(const TuneResult& result, const TuneParameters& base);

}  // namespace sextant
