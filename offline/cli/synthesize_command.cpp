// SPDX-License-Identifier: Apache-2.0
#include "offline/cli/synthesize_command.h"

#include <fmt/format.h>
#include <malloc.h>

#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "offline/cli/mesh_options.h"
#include "offline/cli/object_file.h"
#include "offline/cli/progress_bar.h"
#include "offline/synthesize/synthesize.h"
#include "runtime/base/error.h"

namespace sextant {
namespace {

struct Arguments {
  std::vector<std::string> inputs;
  std::vector<int> object_ids;
  MeshArguments mesh_arguments;
  std::vector<std::string> distractors;
  SynthesisOptions options;
  std::string occlusion = "0:0.5", instances = "1:1";
  std::optional<double> min_visible;
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

std::vector<SynthesisTarget> load_targets(const Arguments& a) {
  if (!a.object_ids.empty() && a.object_ids.size() != a.inputs.size()) {
    throw UsageError(fmt::format("{} object ids for {} objects", a.object_ids.size(), a.inputs.size()),
                     "give --object-id once per object, in their order");
  }
  std::vector<SynthesisTarget> targets;
  for (std::size_t i = 0; i < a.inputs.size(); ++i) {
    SynthesisTarget target;
    LoadedObject loaded = load_object_file(a.inputs[i], a.mesh_arguments);
    target.object = std::move(loaded.object);
    target.object_id = loaded.id.value_or(1);
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
  scene.occlusion = parse_range(a.occlusion, "--occlusion");
  if (a.min_visible) scene.occlusion = {0, 1 - *a.min_visible};
  a.options.instances = parse_range(a.instances, "--instances");
  const std::vector<SynthesisTarget> targets = load_targets(a);
  std::vector<StandingObject> distractors;
  for (const std::string& text : a.distractors)
    distractors.push_back(load_object_file(text, a.mesh_arguments).object);
  // Images come and go by the megabyte: kept in the heap instead of being given back to the system each time.
  mallopt(M_MMAP_THRESHOLD, 1 << 30);
  mallopt(M_TRIM_THRESHOLD, 1 << 30);
  ProgressBar progress("synthesize");
  const SynthesisSummary summary =
      synthesize_dataset(targets, distractors, a.options,
                         [&](std::size_t done, std::size_t total) { progress.show(done, total); });
  if (a.json) {
    nlohmann::ordered_json json{{"dataset", a.options.output.string()},
                                {"images", summary.images},
                                {"negatives", a.options.negatives},
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
  command
      ->add_option(
          "inputs", a.inputs,
          "Meshes (PLY, OBJ, STL, glTF/GLB, DAE) or compiled models; FILE@UNITS[,UP] where one differs from "
          "--units and --up")
      ->required()
      ->type_name("MODEL_OR_MESH");
  command->add_option("-o,--output", a.options.output, "Folder of the data set")
      ->required()
      ->type_name("DIR");
  command->add_option("--images", a.options.images, "Number of images with an object; the objects take turns")
      ->check(CLI::Range(0, 1000000))
      ->capture_default_str();
  command
      ->add_option("--negatives", a.options.negatives,
                   "Number of images without any of the objects, after them")
      ->check(CLI::Range(0, 1000000))
      ->capture_default_str();
  command->add_option("--sensor", a.options.sensor, "Whose faults the images have")
      ->check(CLI::IsMember({"kinect1", "xtion", "realsense", "none"}))
      ->capture_default_str();
  command->add_option("--seed", a.options.seed, "Image k depends on the seed and k alone")
      ->capture_default_str();
  command->add_option("--objects-per-image", a.options.targets_per_image, "Different objects in one image")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--instances", a.instances, "How many of each object in one image, MIN:MAX")
      ->capture_default_str();
  command
      ->add_option("--distractor", a.distractors, "Meshes or models that stand around without being labelled")
      ->type_name("MODEL_OR_MESH")
      ->expected(1, 1000);
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
      ->add_option(
          "--occlusion", a.occlusion,
          "Share of each object that others hide, MIN:MAX of 0..0.95; what stands in front is added or "
          "taken away until it fits")
      ->capture_default_str();
  command->add_option("--min-visible", a.min_visible, "The same as --occlusion 0:(1 - V)")
      ->check(CLI::Range(0.05, 1.0))
      ->excludes("--occlusion");
  command->add_option("--cut", a.options.scene.cut_share, "Share of the objects that the image's border cuts")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command
      ->add_option("--decoys", a.options.scene.decoy_share,
                   "Share of the clutter that is as large as an object and printed otherwise")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command
      ->add_option("--no-depth", a.options.no_depth_share,
                   "Share of the objects that give no depth, as shiny ones do")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command
      ->add_option("--misregistration-px", a.options.misregistration_px,
                   "Rms shift of the depth against the colour, per axis (default: the sensor's)")
      ->check(CLI::Range(0.0, 50.0));
  command->add_option("--threads", a.options.threads, "0: all cores; the images do not depend on it")
      ->check(CLI::Range(0, 256))
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
