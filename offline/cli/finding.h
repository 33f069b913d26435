// SPDX-License-Identifier: Apache-2.0
// One thing that a check found, and what to do about it.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace sextant {

enum class FindingState : std::uint8_t {
  kGood,
  kNote,     ///< worth knowing, nothing to do
  kWarning,  ///< works, but not as well as it could
  kBad,      ///< does not work
};

struct Finding {
  FindingState state = FindingState::kGood;
  std::string check;   ///< what was looked at, e.g. "socket buffers"
  std::string what;    ///< what was found
  std::string advice;  ///< what to do; empty where there is nothing
};

/// Prints one line each ("warn  socket buffers  ..."), advice on a line of its own below.
void print_findings(const std::vector<Finding>& findings);
/// [{"state", "check", "what", "advice"}]
nlohmann::ordered_json findings_json(const std::vector<Finding>& findings);
bool any_bad(const std::vector<Finding>& findings);

}  // namespace sextant
