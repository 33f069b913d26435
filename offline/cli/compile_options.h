// SPDX-License-Identifier: Apache-2.0
// The options of `compile`, shared by sextant and sextant-mpi.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "offline/cli/mesh_options.h"
#include "offline/learn/parameters.h"

namespace sextant {

struct CompileArguments {
  std::filesystem::path mesh;
  std::filesystem::path output;
  std::filesystem::path parameter_file;
  std::string pitch_deg;
  bool all_orientations = false;
  MeshArguments mesh_arguments;
  std::optional<int> id;
  std::optional<std::uint64_t> seed;
  int threads = 0;

  void add_to(CLI::App& command);
  /// File, then --pitch-deg, --all-orientations and --seed on top. Throws UsageError, InputError.
  LearnParameters parameters() const;
  /// --object-id, else the number in the mesh's file name, else 1.
  int object_id() const;
};

}  // namespace sextant
