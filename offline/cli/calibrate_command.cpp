// SPDX-License-Identifier: Apache-2.0
#include "offline/cli/calibrate_command.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <numbers>

#include "offline/calibrate/calibrate.h"
#include "offline/cli/progress_bar.h"
#include "runtime/base/error.h"
#include "runtime/model/model_file.h"

namespace sextant {
namespace {

struct Arguments {
  std::vector<std::filesystem::path> models;
  std::vector<std::filesystem::path> datasets;
  std::string split = "test";
  double angle_tolerance_deg = 12;
  double min_visible = 0.5;
  bool check = false, geometric = false, show_pooled = false;
  DetectOptions detect;
};

std::string listed(const std::array<float, kConfidenceFeatures + 1>& weights) {
  std::string text;
  for (const float w : weights) text += fmt::format("{}{:.2f}", text.empty() ? "" : ", ", w);
  return text;
}

int run(const Arguments& a) {
  std::vector<ObjectModel> models;
  for (const auto& file : a.models) models.push_back(read_model(file));
  std::vector<BopDataset> datasets;
  for (const auto& folder : a.datasets) {
    datasets.push_back(open_bop_dataset(folder, a.split));
    if (!datasets.back().has_ground_truth) {
      throw InputError((folder / a.split).string(), "has no ground truth", "scene_gt.json is missing");
    }
  }
  DetectOptions options = a.detect;
  options.tolerance.angle_rad = a.angle_tolerance_deg * std::numbers::pi / 180;
  std::vector<ObjectObservations> observed;
  {
    ProgressBar bar("images");
    observed = observe(models, datasets, options, a.geometric, a.min_visible,
                       [&](std::size_t done, std::size_t total) { bar.show(done, total); });
  }
  const auto pooled = pooled_weights(observed);
  if (a.show_pooled) fmt::print("weights of all objects together: {}\n", listed(pooled));
  std::vector<Answer> all;
  for (std::size_t i = 0; i < models.size(); ++i) {
    if (!a.check) models[i].confidence = calibrated(observed[i], pooled, a.models[i].string());
    const std::vector<Answer> answers = answers_of(models[i].confidence, observed[i]);
    all.insert(all.end(), answers.begin(), answers.end());
    if (!a.check) {
      write_model(models[i], a.models[i]);
      fmt::print(
          "{}: {} images, {} detections; weights {}; confidence for 10 % / 1 % false detections per image "
          "{:.2f} / {:.2f}\n",
          a.models[i].string(), observed[i].images, observed[i].detections.size(),
          listed(models[i].confidence.weights), threshold_for_false_positive_rate(models[i].confidence, 0.1),
          threshold_for_false_positive_rate(models[i].confidence, 0.01));
    }
  }
  fmt::print("{}", format_reliability(reliability(all)));
  return static_cast<int>(ExitCode::kDone);
}

}  // namespace

CLI::App* add_calibrate_command(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<Arguments>();
  Arguments& a = *arguments;
  a.detect.max_detections = 2;
  CLI::App* command = app.add_subcommand(
      "calibrate", "confidence and threshold of compiled models, from data sets with ground truth");
  command->add_option("models", a.models, "compiled models (.sxm), written back")->required();
  command->add_option("--dataset", a.datasets, "BOP data sets, with and without the objects")
      ->required()
      ->type_name("DIR");
  command->add_option("--split", a.split, "of the data sets")->capture_default_str();
  command->add_flag("--check", a.check, "only say how well the models' confidences fit; write nothing");
  command->add_flag("--geometric", a.geometric, "a pose is right up to the symmetry of the shape alone");
  command->add_flag("--show-pooled", a.show_pooled, "print the weights of all objects together");
  command->add_option("--min-visible", a.min_visible, "ignore objects of which less is seen")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command->add_option("--threshold", a.detect.threshold, "log score that a detection must reach");
  command
      ->add_option("--max-detections", a.detect.max_detections,
                   "per object and image: as many places as detection looks at")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  command->add_option("--angle-tolerance-deg", a.angle_tolerance_deg, "of the table constraint")
      ->check(CLI::Range(0.0, 45.0))
      ->capture_default_str();
  command->add_option("--threads", a.detect.threads, "0: all cores")->check(CLI::Range(0, 256));
  command->footer(
      "Example:\n  sextant synthesize box.obj --units mm -o scenes --images 200\n"
      "  sextant calibrate box.sxm --dataset scenes");
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
  return command;
}

}  // namespace sextant
