// SPDX-License-Identifier: Apache-2.0
// sextant-mpi compile: learning spread over ranks. The model is byte for byte the one that `sextant compile`
// makes.
#pragma once

#include <CLI/CLI.hpp>

namespace sextant {

CLI::App* add_mpi_compile_command(CLI::App& app, int& exit_code);

}  // namespace sextant
