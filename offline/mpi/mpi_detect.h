// SPDX-License-Identifier: Apache-2.0
// sextant-mpi detect: the search of every frame spread over ranks. The answer is the one of `sextant detect`.
#pragma once

#include <CLI/CLI.hpp>

namespace sextant {

CLI::App* add_mpi_detect_command(CLI::App& app, int& exit_code);

}  // namespace sextant
