// SPDX-License-Identifier: Apache-2.0
// sextant calibrate: confidences that mean something, for compiled models.
#pragma once

#include <CLI/CLI.hpp>

namespace sextant {

CLI::App* add_calibrate_command(CLI::App& app, int& exit_code);

}  // namespace sextant
