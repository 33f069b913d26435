// SPDX-License-Identifier: Apache-2.0
// An object named on the command line: a mesh, with its own units where they differ, or a compiled model.
#pragma once

#include <optional>
#include <string>

#include "offline/cli/mesh_options.h"

namespace sextant {

struct LoadedObject {
  StandingObject object;
  std::optional<int> id;  ///< the model's, or the number in the mesh's file name
};

/// FILE, or FILE@UNITS or FILE@UNITS,UP where it differs from what the options say for all. A model gives its
/// simplified mesh, grey. Throws UsageError, InputError.
LoadedObject load_object_file(const std::string& text, const MeshArguments& for_all);

}  // namespace sextant
