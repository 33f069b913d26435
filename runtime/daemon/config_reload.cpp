// SPDX-License-Identifier: Apache-2.0
#include "runtime/daemon/config_reload.h"

#include <fmt/format.h>

#include "runtime/base/error.h"

namespace sextant {

namespace {

struct Difference {
  std::string key;
  bool reloads;
};

std::vector<Difference> differences(DaemonConfig before, DaemonConfig after) {
  std::vector<Difference> found;
  const std::vector<ConfigField> a = config_fields(before);
  const std::vector<ConfigField> b = config_fields(after);
  for (std::size_t i = 0; i < a.size(); ++i) {
    const bool same = std::visit(
        [&](auto* value) { return *value == *std::get<decltype(value)>(b[i].target); }, a[i].target);
    if (!same) found.push_back({a[i].section + "." + a[i].key, a[i].reloads});
  }
  return found;
}

}  // namespace

std::vector<std::string> changed_keys(const DaemonConfig& before, const DaemonConfig& after) {
  std::vector<std::string> keys;
  for (const Difference& difference : differences(before, after)) keys.push_back(difference.key);
  return keys;
}

std::vector<std::string> check_reload(const DaemonConfig& running, const DaemonConfig& changed,
                                      const std::string& where) {
  std::vector<std::string> fixed, keys;
  for (const Difference& difference : differences(running, changed)) {
    keys.push_back(difference.key);
    if (!difference.reloads) fixed.push_back(difference.key);
  }
  if (!fixed.empty()) {
    throw InputError(where, fmt::format("{} cannot change while the daemon runs", fmt::join(fixed, ", ")),
                     "restart it, or put the old value back");
  }
  return keys;
}

}  // namespace sextant
