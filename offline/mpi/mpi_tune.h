// SPDX-License-Identifier: Apache-2.0
// sextant-mpi tune: the points of a sweep spread over ranks that share the output folder. The result is the
// one of `sextant tune`.
#pragma once

#include <CLI/CLI.hpp>

namespace sextant {

CLI::App* add_mpi_tune_command(CLI::App& app, int& exit_code);

}  // namespace sextant
