// SPDX-License-Identifier: Apache-2.0
#include "hal/source_status.h"

namespace sextant {

const char* name_of(DropReason reason) {
  switch (reason) {
    case DropReason::kLost:
      return "lost";
    case DropReason::kDamaged:
      return "damaged";
    case DropReason::kStale:
      return "stale";
    case DropReason::kSuperseded:
      return "superseded";
    case DropReason::kBadTime:
      return "without a believable time";
    case DropReason::kUnpaired:
      return "unpaired";
    case DropReason::kRefused:
      return "refused";
    case DropReason::kUnwritten:
      return "unwritten";
  }
  return "?";
}

std::string describe_drops(const SourceStatistics& statistics) {
  std::string text;
  for (std::size_t i = 0; i < kDropReasons; ++i) {
    if (statistics.drops[i] == 0) continue;
    if (!text.empty()) text += ", ";
    text += std::to_string(statistics.drops[i]) + " " + name_of(static_cast<DropReason>(i));
  }
  return text.empty() ? "none" : text;
}

}  // namespace sextant
