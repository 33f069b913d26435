// SPDX-License-Identifier: Apache-2.0
// sextant-mpi serve: the daemon, with a search that is spread over ranks. What it publishes is what sextantd
// publishes.
#pragma once

#include <CLI/CLI.hpp>

namespace sextant {

CLI::App* add_mpi_serve_command(CLI::App& app, int& exit_code);

}  // namespace sextant
