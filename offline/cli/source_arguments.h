// SPDX-License-Identifier: Apache-2.0
// The options that name a source of frames, shared by sextant record and sextant camera.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "hal/sources/open_source.h"

namespace sextant {

struct SourceArguments {
  SourceOptions source;
  bool by_timestamps = false;
  bool no_rectify = false;
  double max_age_ms = 100;

  void add_to(CLI::App& command);
  /// Applies what the flags mean. Throws UsageError.
  SourceOptions options() const;
  /// "playback of data/sample", "v4l2 A + B", ...: for people.
  std::string describe() const;
};

}  // namespace sextant
