// SPDX-License-Identifier: Apache-2.0
// `sextant ask`: asks a running sextantd over DDS to load, enable, look once, ... and prints its answer.
#pragma once

#include <CLI/App.hpp>
#include <cstdio>
#include <string>

#include "runtime/publish/command.h"
#include "runtime/publish/command_server.h"

namespace sextant {

/// Options that all questions share.
struct AskOptions {
  unsigned domain = 0;          ///< 0..230
  CommandServerOptions topics;  ///< as the daemon's publish.namespace and commands.*
  double timeout_s = 20;        ///< for the answer
  bool json = false;
  bool require = false;  ///< a look that finds nothing is exit code 1
};

/// Sends the command under a new request id and prints the answer to `out`. Returns 0; 1 where a look with
/// --require found nothing; 2 where the daemon refused; 3 where it tried in vain. Throws DeviceError where no
/// answer came.
int run_ask(const AskOptions& options, Command command, std::FILE* out);

/// Adds the subcommand; when it is chosen, parsing runs it and stores its exit code.
CLI::App* add_ask_command(CLI::App& app, int& exit_code);

}  // namespace sextant
