// SPDX-License-Identifier: Apache-2.0
// The configuration as a documented YAML file: what config/sextantd.yaml is, and what
// `sextantd --print-config-reference` prints.
#pragma once

#include <string>

#include "runtime/daemon/daemon_config.h"

namespace sextant {

/// Every key with its meaning, unit, range and default, set to the values of `config`. Reading it back gives
/// the same configuration.
std::string config_reference(const DaemonConfig& config);

}  // namespace sextant
