// SPDX-License-Identifier: Apache-2.0
#include "runtime/publish/command.h"

#include <fmt/format.h>

namespace sextant {

std::string to_string(CommandKind kind) {
  static constexpr std::array kNames = {"status", "load",      "unload",   "enable", "disable",
                                        "region", "threshold", "deadline", "look",   "reload"};
  const auto index = static_cast<std::size_t>(kind);
  return index < kNames.size() ? kNames[index] : fmt::format("kind {}", index);
}

}  // namespace sextant
