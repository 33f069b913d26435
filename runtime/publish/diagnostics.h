// SPDX-License-Identifier: Apache-2.0
// How the daemon is: what goes out on the diagnostics topic, one status per part of it.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "runtime/refine/frame_result.h"

namespace sextant {

/// As diagnostic_msgs/DiagnosticStatus numbers them.
enum class DiagnosticLevel : std::uint8_t { kOk = 0, kWarn = 1, kError = 2, kStale = 3 };

/// One part.
struct DiagnosticStatus {
  DiagnosticLevel level = DiagnosticLevel::kOk;
  std::string name;     ///< "sextantd: pipeline"
  std::string message;  ///< one line for people
  std::vector<std::pair<std::string, std::string>> values{};
};

/// All parts at one time.
struct DiagnosticReport {
  CaptureTime at{};         ///< when it was made: a report, unlike a pose, is about now
  std::string hardware_id;  ///< which of several daemons
  std::vector<DiagnosticStatus> parts;
};

}  // namespace sextant
