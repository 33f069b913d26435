// SPDX-License-Identifier: Apache-2.0
// The daemon as a whole: configuration in, frames from the hardware layer, poses out over DDS, until a
// signal. sextantd and `sextant-mpi serve` are this behind two command lines.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "runtime/daemon/daemon.h"
#include "runtime/daemon/detection_service.h"

namespace sextant {

/// What the command line asks for.
struct ServeArguments {
  std::string config;
  bool check_config = false;
  bool once = false;
  bool reference = false;
  void add_to(CLI::App& app);
};

/// Does what is asked for. search_elsewhere: who else searches (may be empty). Throws as everything below it
/// does: UsageError, InputError, DeviceError.
void serve(const ServeArguments& arguments, SignalWaiter& signals,
           const SearchElsewhere& search_elsewhere = {});

}  // namespace sextant
