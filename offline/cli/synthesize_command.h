// SPDX-License-Identifier: Apache-2.0
// sextant synthesize: a BOP data set of rendered table scenes with a real sensor's noise.
#pragma once

#include <CLI/CLI.hpp>

namespace sextant {

CLI::App* add_synthesize_command(CLI::App& app, int& exit_code);

}  // namespace sextant
