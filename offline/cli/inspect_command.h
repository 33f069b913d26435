// SPDX-License-Identifier: Apache-2.0
// `sextant inspect`: what a compiled model holds, where it came from, and a picture of its bins.
#pragma once

#include <CLI/App.hpp>

namespace sextant {

/// Adds the subcommand. When it was given on the command line, its callback prints to stdout and sets
/// exit_code; a bad model is thrown as InputError.
CLI::App* add_inspect_command(CLI::App& app, int& exit_code);

}  // namespace sextant
