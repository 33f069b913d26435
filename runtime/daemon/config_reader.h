// SPDX-License-Identifier: Apache-2.0
// YAML -> DaemonConfig. The file is hostile until checked: every error is an InputError that names file,
// line, key and what to write instead.
#pragma once

#include <filesystem>
#include <string>

#include "runtime/daemon/daemon_config.h"

namespace sextant {

/// Reads and checks a file of at most 256 KiB.
DaemonConfig read_config(const std::filesystem::path& file);

/// Same for text; `where` names it in errors, relative paths start at `folder`.
DaemonConfig parse_config(const std::string& text, const std::string& where,
                          const std::filesystem::path& folder);

}  // namespace sextant
