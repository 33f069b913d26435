// SPDX-License-Identifier: Apache-2.0
// A changed configuration file for a running daemon: which keys may differ, and which need a new start.
#pragma once

#include <string>
#include <vector>

#include "runtime/daemon/daemon_config.h"

namespace sextant {

/// Keys ("section.key") whose values differ, in the order of the file.
std::vector<std::string> changed_keys(const DaemonConfig& before, const DaemonConfig& after);

/// Returns the changed keys; throws InputError(where) when one of them cannot change while the daemon runs.
std::vector<std::string> check_reload(const DaemonConfig& running, const DaemonConfig& changed,
                                      const std::string& where);

}  // namespace sextant
