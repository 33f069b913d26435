// SPDX-License-Identifier: Apache-2.0
#include "offline/cli/compile_options.h"

#include <cstdio>

#include "offline/cli/object_id.h"
#include "runtime/base/error.h"

namespace sextant {

void CompileArguments::add_to(CLI::App& command) {
  command.add_option("mesh", mesh, "PLY, OBJ, STL, glTF/GLB or DAE file")->required();
  command.add_option("-o,--output", output, "model file to write")->required();
  mesh_arguments.add_to(command);
  command.add_option("--pitch-deg", pitch_deg,
                     "MIN:MAX: how far the cameras that will be used look down (default 25:55)");
  command.add_flag("--all-orientations", all_orientations,
                   "not only what stands on a table: every orientation, for searches with --table none");
  command.add_option("--params", parameter_file, "YAML file of learning parameters");
  command
      .add_option("--object-id", id, "BOP object id (default: the number in the mesh's file name, else 1)")
      ->check(CLI::Range(0, 999999));
  command.add_option("--threads", threads, "0: all cores")->check(CLI::Range(0, 256))->capture_default_str();
  command.add_option("--seed", seed, "of the random training views");
}

LearnParameters CompileArguments::parameters() const {
  LearnParameters p = parameter_file.empty() ? LearnParameters{} : read_learn_parameters(parameter_file);
  if (!pitch_deg.empty()) {
    int used = 0;
    if (std::sscanf(pitch_deg.c_str(), "%lf:%lf%n", &p.min_pitch_deg, &p.max_pitch_deg, &used) != 2 ||
        static_cast<std::size_t>(used) != pitch_deg.size()) {
      throw UsageError("--pitch-deg " + pitch_deg + " is not MIN:MAX", "for example --pitch-deg 30:50");
    }
  }
  if (all_orientations) {
    p.all_orientations = 1;
    p.learn_table = 0;
  }
  if (seed) p.seed = *seed;
  p.check();
  return p;
}

int CompileArguments::object_id() const { return id ? *id : object_id_in_name(mesh).value_or(1); }

}  // namespace sextant
