// SPDX-License-Identifier: Apache-2.0
#include "offline/cli/tune_options.h"

#include <fmt/format.h>
#include <xxhash.h>

#include "hal/image/file_bytes.h"
#include "offline/cli/object_id.h"
#include "offline/tune/tune_report.h"
#include "runtime/base/error.h"
#include "runtime/base/version.h"

namespace sextant {
namespace {

/// Stands for the images and their truth: where they are, their sizes and every pose.
std::string fingerprint(const std::vector<BopImage>& images) {
  std::string text;
  std::error_code error;
  for (const BopImage& image : images) {
    text += fmt::format("{} {} {} {}", image.scene_id, image.image_id,
                        std::filesystem::file_size(image.colour, error),
                        std::filesystem::file_size(image.depth, error));
    for (const BopGt& gt : image.ground_truth) {
      const Eigen::Vector3d t = gt.camera_from_mesh.translation();
      text += fmt::format(" {} {} {} {} {}", gt.object_id, t.x(), t.y(), t.z(),
                          gt.camera_from_mesh.linear()(0, 0));
    }
    text += "\n";
  }
  return fmt::format("{:016x}", XXH3_64bits(text.data(), text.size()));
}

void write_text(const std::filesystem::path& file, const std::string& text) {
  write_file_bytes(file, std::as_bytes(std::span(text)));
}

}  // namespace

void TuneArguments::add_to(CLI::App& command) {
  command.add_option("mesh", mesh, "PLY, OBJ, STL, glTF/GLB or DAE file")->required();
  command.add_option("--dataset", dataset, "labelled BOP data set: half of it for training, half held out")
      ->required()
      ->type_name("DIR");
  command
      .add_option("--held-out", held_out,
                  "another data set for the report; then all of --dataset is for training")
      ->type_name("DIR");
  command
      .add_option(
          "--sweep", sweeps,
          "NAME=V1,V2,..: a learning parameter, or height_tolerance_m, threshold, scoring, search_width; "
          "repeatable")
      ->required()
      ->type_name("NAME=VALUES")
      ->expected(1, 100);
  command.add_flag("--grid", grid, "every combination, not one parameter at a time");
  command
      .add_option("-o,--output", folder,
                  "folder for trials, models, tuned.yaml and report.html; a run that was "
                  "stopped goes on from there")
      ->required()
      ->type_name("DIR");
  command
      .add_option("--metric", metric,
                  "ap: average precision | right: within 1 cm and 15 deg | strict: 5 mm, 5 deg")
      ->check(CLI::IsMember({"ap", "right", "strict"}))
      ->capture_default_str();
  mesh_arguments.add_to(command);
  command.add_option("--params", parameter_file, "YAML file of learning parameters to start from");
  command
      .add_option("--object-id", id, "BOP object id (default: the number in the mesh's file name, else 1)")
      ->check(CLI::Range(0, 999999));
  command.add_option("--split", split, "of the data sets")->capture_default_str();
  command.add_option("--scoring", scoring, "to start from")->capture_default_str();
  command.add_option("--height-tolerance-m", height_tolerance_m, "to start from")->capture_default_str();
  command.add_option("--deadline-ms", deadline_ms, "for the search of one image, 0: none")
      ->capture_default_str();
  command.add_option("--threads", threads, "0: all cores")->check(CLI::Range(0, 256))->capture_default_str();
  command.add_flag("--json", json, "print one JSON object");
}

PreparedTuning prepare_tuning(const TuneArguments& a) {
  PreparedTuning tuning;
  if (!a.parameter_file.empty()) tuning.base.learn = read_learn_parameters(a.parameter_file);
  tuning.base.detect.scoring = a.scoring;
  tuning.base.detect.tolerance.height_m = a.height_tolerance_m;
  tuning.base.detect.deadline_ms = a.deadline_ms;
  tuning.base = apply(tuning.base, {});
  for (const std::string& text : a.sweeps) tuning.run.sweeps.push_back(parse_sweep(text));
  tuning.run.grid = a.grid;
  tuning.run.metric = a.metric;
  tuning.run.folder = a.folder;
  // Every point's values are checked before hours of work.
  for (const TunePoint& point : points_of(tuning.run.sweeps, a.grid)) apply(tuning.base, point);

  DetectorTrialOptions options;
  options.object = load_standing_object(a.mesh, a.mesh_arguments.options());
  options.mesh_name = a.mesh.filename().string();
  options.object_id = a.id ? *a.id : object_id_in_name(a.mesh).value_or(1);
  options.base = tuning.base;
  options.folder = a.folder;
  options.threads = a.threads;
  const BopDataset set = open_bop_dataset(a.dataset, a.split);
  if (a.held_out.empty()) {
    options.images = split_images(set.images, options.object_id);
  } else {
    options.images.training = set.images;
    options.images.held_out = open_bop_dataset(a.held_out, a.split).images;
  }
  tuning.run.identity =
      fmt::format("{} {:016x} {} {} {} {} {} {} {} {}", kProgramVersion, options.object.file_hash,
                  options.object.symmetry_deg, options.object_id, fingerprint(options.images.training),
                  fingerprint(options.images.held_out), tuning.base.learn.to_yaml(), a.scoring,
                  a.height_tolerance_m, a.deadline_ms);
  tuning.trial = detector_trial(std::move(options));
  return tuning;
}

void report_tuning(const TuneArguments& a, const PreparedTuning& tuning, const TuneResult& result) {
  write_text(a.folder / "tuned.yaml", format_tuned_yaml(result, tuning.base));
  write_text(a.folder / "report.html",
             format_tune_html(tuning.run, result, "Tuning of " + a.mesh.filename().string()));
  if (a.json) {
    fmt::print("{}\n", format_tune_json(tuning.run, result));
    return;
  }
  fmt::print("{}wrote {} and {}\n", format_tune_text(tuning.run, result), (a.folder / "tuned.yaml").string(),
             (a.folder / "report.html").string());
}

}  // namespace sextant
