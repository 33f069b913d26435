// SPDX-License-Identifier: Apache-2.0
#include "offline/cli/finding.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace sextant {
namespace {

const char* name_of(FindingState state) {
  switch (state) {
    case FindingState::kGood:
      return "good";
    case FindingState::kNote:
      return "note";
    case FindingState::kWarning:
      return "warning";
    case FindingState::kBad:
      return "bad";
  }
  return "?";
}

}  // namespace

void print_findings(const std::vector<Finding>& findings) {
  for (const Finding& f : findings) {
    fmt::print("{:<8} {:<18} {}\n", name_of(f.state), f.check, f.what);
    if (!f.advice.empty()) fmt::print("{:<8} {:<18}   -> {}\n", "", "", f.advice);
  }
}

nlohmann::ordered_json findings_json(const std::vector<Finding>& findings) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Finding& f : findings) {
    list.push_back({{"state", name_of(f.state)}, {"check", f.check}, {"what", f.what}, {"advice", f.advice}});
  }
  return list;
}

bool any_bad(const std::vector<Finding>& findings) {
  return std::any_of(findings.begin(), findings.end(),
                     [](const Finding& f) { return f.state == FindingState::kBad; });
}

}  // namespace sextant
