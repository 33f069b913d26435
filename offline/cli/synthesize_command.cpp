// SPDX-License-Identifier: Apache-2.0
#include "offline/cli/synthesize_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>

#include "offline/cli/mesh_options.h"
#include "offline/cli/object_id.h"
#include "offline/cli/progress_bar.h"
#include "offline/synthesize/synthesize.h"
#include "runtime/base/error.h"
#include "runtime/model/model_file.h"

namespace sextant {
namespace {

struct Arguments {
  std::vector<std::filesystem::path> inputs;
  std::vector<int> object_ids;
  MeshArguments mesh_arguments;
  SynthesisOptions options;
  std::string pitch = "30:50", roll = "-3:3", height = "0.5:0.85", distance = "0.5:1.3", clutter = "4:9";
  std::string size = "640x480";
  double focal = 525;
  bool json = false;
};

Range parse_range(const std::string& text, const char* option) {
  Range range;
  int used = 0;
  if (std::sscanf(text.c_str(), "%lf:%lf%n", &range.lo, &range.hi, &used) != 2 ||
      static_cast<std::size_t>(used) != text.size()) {
    throw UsageError(fmt::format("{} {} is not MIN:MAX", option, text),
                     fmt::format("for example {} 30:50", option));
  }
  return range;
}

PinholeCamera parse_camera(const Arguments& a) {
  PinholeCamera camera;
  int used = 0;
  if (std::sscanf(a.size.c_str(), "%dx%d%n", &camera.width, &camera.height, &used) != 2 ||
      static_cast<std::size_t>(used) != a.size.size() || camera.width < 64 || camera.height < 64 ||
      camera.width > 4096 || camera.height > 4096) {
    throw UsageError("--size " + a.size + " is not WIDTHxHEIGHT with 64..4096 pixels",
                     "for example --size 640x480");
  }
  camera.focal = a.focal;
  camera.cx = (camera.width - 1) / 2.0;
  camera.cy = (camera.height - 1) / 2.0;
  return camera;
}

bool is_mesh(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  static const std::set<std::string> kMeshes{".ply", ".obj", ".stl", ".gltf", ".glb", ".dae"};
  return kMeshes.count(extension) > 0;
}

std::vector<SynthesisTarget> load_targets(const Arguments& a) {
  if (!a.object_ids.empty() && a.object_ids.size() != a.inputs.size()) {
    throw UsageError(fmt::format("{} object ids for {} objects", a.object_ids.size(), a.inputs.size()),
                     "give --object-id once per object, in their order");
  }
  std::vector<SynthesisTarget> targets;
  for (std::size_t i = 0; i < a.inputs.size(); ++i) {
    SynthesisTarget target;
    if (is_mesh(a.inputs[i])) {
      target.object = load_standing_object(a.inputs[i], a.mesh_arguments.options());
      target.object_id = object_id_in_name(a.inputs[i]).value_or(1);
    } else {
      const ObjectModel model = read_model(a.inputs[i]);
      target.object = standing_object_of(model);
      target.object_id = model.object_id;
    }
    if (!a.object_ids.empty()) target.object_id = a.object_ids[i];
    targets.push_back(std::move(target));
  }
  return targets;
}

void run(Arguments& a) {
  SceneOptions& scene = a.options.scene;
  scene.camera = parse_camera(a);
  scene.pitch_deg = parse_range(a.pitch, "--pitch-deg");
  scene.roll_deg = parse_range(a.roll, "--roll-deg");
  scene.height_m = parse_range(a.height, "--height-m");
  scene.distance_m = parse_range(a.distance, "--distance-m");
  scene.clutter = parse_range(a.clutter, "--clutter");
  const std::vector<SynthesisTarget> targets = load_targets(a);
  ProgressBar progress("synthesize");
  const SynthesisSummary summary = synthesize_dataset(
      targets, a.options, [&](std::size_t done, std::size_t total) { progress.show(done, total); });
  if (a.json) {
    nlohmann::ordered_json json{{"dataset", a.options.output.string()},
                                {"images", summary.images},
                                {"instances", summary.instances},
                                {"mean_visible_fraction", summary.mean_visible_fraction}};
    for (const SynthesisTarget& target : targets) json["object_ids"].push_back(target.object_id);
    fmt::print("{}\n", json.dump());
  } else {
    fmt::print("{}: {} images, {} instances, {:.0f} % visible on average\n", a.options.output.string(),
               summary.images, summary.instances, 100 * summary.mean_visible_fraction);
  }
}

}  // namespace

CLI::App* add_synthesize_command(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<Arguments>();
  Arguments& a = *arguments;
  CLI::App* command =
      app.add_subcommand("synthesize", "Render table scenes with a real sensor's noise as a BOP data set");
  command->add_option("inputs", a.inputs, "Meshes (PLY, OBJ, STL, glTF/GLB, DAE) or compiled models")
      ->required()
      ->type_name("MODEL_OR_MESH");
  command->add_option("-o,--output", a.options.output, "Folder of the data set")
      ->required()
      ->type_name("DIR");
  command->add_option("--images", a.options.images, "Number of images; the objects take turns")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  command->add_option("--sensor", a.options.sensor, "Whose faults the images have")
      ->check(CLI::IsMember({"kinect1", "xtion", "realsense", "none"}))
      ->capture_default_str();
  command->add_option("--seed", a.options.seed, "Image k depends on the seed and k alone")
      ->capture_default_str();
  command->add_option("--objects-per-image", a.options.targets_per_image, "Different objects in one image")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command
      ->add_option(
          "--object-id", a.object_ids,
          "BOP object ids, one per input (default: the model's, else the number in the file's name, else 1)")
      ->check(CLI::Range(0, 999999))
      ->expected(1, 1000);
  a.mesh_arguments.add_to(*command);
  command->add_option("--pitch-deg", a.pitch, "How far the camera looks down, MIN:MAX")
      ->capture_default_str();
  command->add_option("--roll-deg", a.roll, "Roll of the camera, MIN:MAX")->capture_default_str();
  command->add_option("--height-m", a.height, "Height of the camera above the table, MIN:MAX")
      ->capture_default_str();
  command->add_option("--distance-m", a.distance, "Distance of the object, MIN:MAX")->capture_default_str();
  command->add_option("--clutter", a.clutter, "Number of other things on the table, MIN:MAX")
      ->capture_default_str();
  command
      ->add_option("--min-visible", a.options.scene.min_visible, "Share of the object that is seen at least")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command->add_option("--size", a.size, "Pixels of the images, WIDTHxHEIGHT")->capture_default_str();
  command->add_option("--focal", a.focal, "Focal length, pixels")
      ->check(CLI::Range(20.0, 20000.0))
      ->capture_default_str();
  command->add_flag("--json", a.json, "Print one JSON object");
  command->footer(
      "Example: sextant synthesize mug.ply --units mm -o sample --images 20 --sensor kinect1 --seed 7");
  command->callback([arguments, &exit_code] {
    run(*arguments);
    exit_code = static_cast<int>(ExitCode::kDone);
  });
  return command;
}

}  // namespace sextant
