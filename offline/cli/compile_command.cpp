// SPDX-License-Identifier: Apache-2.0
// sextant compile: mesh -> model.
#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "offline/cli/commands.h"
#include "offline/cli/compile_options.h"
#include "offline/cli/progress_bar.h"
#include "offline/learn/bin_layout.h"
#include "offline/learn/compile.h"
#include "offline/mesh/resting_poses.h"
#include "runtime/base/error.h"
#include "runtime/model/model_file.h"

namespace sextant {
namespace {

struct Arguments {
  CompileArguments compile;
  bool json = false;
};

void print_summary(const Arguments& a, const std::filesystem::path& output, const ObjectModel& model,
                   double seconds) {
  const auto bytes = std::filesystem::file_size(output);
  const double per_bin = seconds / static_cast<double>(model.bins.size());
  if (a.json) {
    fmt::print("{}\n", nlohmann::json{{"model", output.string()},
                                      {"object_id", model.object_id},
                                      {"bins", model.bins.size()},
                                      {"bytes", bytes},
                                      {"symmetry_deg", model.symmetry_deg},
                                      {"geometric_symmetry_deg", model.geometric_symmetry_deg},
                                      {"bounding_radius_m", model.bounding_radius_m},
                                      {"seconds", seconds}}
                           .dump());
    return;
  }
  fmt::print(
      "{}: object {} \"{}\", radius {:.1f} mm, symmetry {} deg (shape {}), {} bins, {:.2f} MB, {:.1f} s "
      "({:.2f} s per bin)\n",
      output.string(), model.object_id, model.name, model.bounding_radius_m * 1e3, model.symmetry_deg,
      model.geometric_symmetry_deg, model.bins.size(), static_cast<double>(bytes) / 1e6, seconds, per_bin);
}

/// Learns one standing object. suffix: of the object's name and of the file's, before its extension.
void learn(const Arguments& a, const StandingObject& object, const std::string& suffix) {
  const LearnParameters parameters = a.compile.parameters();
  const auto start = std::chrono::steady_clock::now();
  const auto boxes = lay_out_bins(parameters, object.symmetry_deg);
  ObjectModel model;
  {
    ProgressBar bar("learning bins");
    model = assemble_model(object, parameters,
                           learn_bins(object, parameters, boxes, a.compile.threads, 0, 1,
                                      [&](std::size_t done, std::size_t total) { bar.show(done, total); }),
                           a.compile.mesh.filename().string(), a.compile.object_id());
  }
  model.name += suffix;
  std::filesystem::path output = a.compile.output;
  output.replace_filename(output.stem().string() + suffix + output.extension().string());
  write_model(model, output);
  print_summary(a, output, model,
                std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
}

void run(const Arguments& a) {
  a.compile.parameters();  // refused before anything is read
  MeshArguments mesh = a.compile.mesh_arguments;
  if (!mesh.several()) {
    const StandingObject object = load_standing_object(a.compile.mesh, mesh.options());
    if (!a.json && !object.resting_poses.empty())
      fmt::print("{}", describe_resting_poses(object.resting_poses));
    learn(a, object, "");
    return;
  }
  if (!mesh.up.empty()) throw UsageError("--up says how the object stands", "leave it out, or --rest");
  MeshArguments first = mesh;
  first.rest = "auto";
  const std::vector<RestingPose> poses = load_standing_object(a.compile.mesh, first.options()).resting_poses;
  if (!a.json) fmt::print("{}", describe_resting_poses(poses));
  std::vector<StandingObject> objects;
  const std::vector<int> rests = mesh.rests(poses);
  for (const int rest : rests) {
    mesh.rest = std::to_string(rest);
    objects.push_back(load_standing_object(a.compile.mesh, mesh.options()));
  }
  for (std::size_t i = 0; i < rests.size(); ++i) {
    learn(a, objects[i], i == 0 ? "" : fmt::format(".rest{}", rests[i]));
  }
}

}  // namespace

CLI::App* add_compile_command(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("compile", "mesh -> compiled model");
  command->footer("Example:\n  sextant compile mug.stl --units mm -o mug.sxm --pitch-deg 30:50");
  arguments->compile.add_to(*command);
  command->add_flag("--json", arguments->json, "machine-readable summary");
  command->callback([arguments, &exit_code] {
    run(*arguments);
    exit_code = static_cast<int>(ExitCode::kDone);
  });
  return command;
}

}  // namespace sextant
