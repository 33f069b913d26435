// SPDX-License-Identifier: Apache-2.0
// An evaluation as a page for people: key numbers, the worst cases as pictures, a table, charts, confusion
// matrices.
#pragma once

#include <string>
#include <vector>

#include "offline/evaluate/evaluation.h"

namespace sextant {

/// A picture of one answer that is wrong.
struct CasePicture {
  std::string caption;  ///< plain text
  std::string jpeg;     ///< bytes
};

/// A self-contained HTML page.
std::string format_report_html(const EvaluationReport& report, const std::string& title,
                               const std::vector<CasePicture>& worst = {});

}  // namespace sextant
