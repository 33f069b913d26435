// SPDX-License-Identifier: Apache-2.0
// `sextant echo`: prints poses that arrive over DDS.
#pragma once

#include <CLI/App.hpp>
#include <cstdio>
#include <string>

namespace sextant {

/// Options of echo.
struct EchoOptions {
  std::string topic = "pose_estimates";  ///< without "rt/", with its namespace
  std::string type{};    ///< detections, object_pose or pose_estimates; empty: by the topic's name
  unsigned domain = 0;   ///< 0..230
  int count = 0;         ///< messages to print; 0: no limit
  double timeout_s = 0;  ///< stop after this time; 0: never
  bool json = false;     ///< one JSON object per line
  bool require = false;  ///< receiving nothing (or fewer than count) is exit code 1
};

/// Prints messages to `out` (each flushed) and warnings to stderr until count, timeout, SIGINT or SIGTERM.
/// Returns 0, or 1 where --require was not met. Throws UsageError for impossible options and DeviceError
/// where DDS or `out` fail.
int run_echo(const EchoOptions& options, std::FILE* out);

/// Adds the subcommand; when it is chosen, parsing runs it and stores its exit code.
CLI::App* add_echo_command(CLI::App& app, int& exit_code);

}  // namespace sextant
