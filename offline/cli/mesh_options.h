// SPDX-License-Identifier: Apache-2.0
// The options that say how to read a mesh, shared by every command that takes one.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "offline/mesh/standing_object.h"

namespace sextant {

struct MeshArguments {
  std::string units = "m";
  std::string up;
  std::string rest = "auto";
  std::string symmetry = "auto";

  void add_to(CLI::App& command);
  /// Throws UsageError for values that make no sense.
  MeshOptions options() const;
};

}  // namespace sextant
