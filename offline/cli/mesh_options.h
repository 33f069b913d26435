// SPDX-License-Identifier: Apache-2.0
// The options that say how to read a mesh, shared by every command that takes one.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

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
  /// More than one resting pose is asked for: all, or several numbers.
  bool several() const { return rest == "all" || rest.find(',') != std::string::npos; }
  /// The numbers of the resting poses that are asked for, of those that the mesh has: all of at least 5 %
  /// probability, or the list. Throws UsageError.
  std::vector<int> rests(const std::vector<RestingPose>& poses) const;
};

}  // namespace sextant
