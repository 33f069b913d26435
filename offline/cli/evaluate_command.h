// SPDX-License-Identifier: Apache-2.0
// sextant evaluate: accuracy of results against the ground truth of a BOP data set.
#pragma once

#include <CLI/CLI.hpp>

namespace sextant {

CLI::App* add_evaluate_command(CLI::App& app, int& exit_code);

}  // namespace sextant
