// SPDX-License-Identifier: Apache-2.0
#include "offline/cli/detect_options.h"

#include <cstdio>
#include <numbers>

#include "runtime/base/error.h"

namespace sextant {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

/// "PITCH_DEG,HEIGHT_M[,ROLL_DEG]".
TableGeometry fixed_table(const std::string& text) {
  double pitch = 0;
  double height = 0;
  double roll = 0;
  int used = 0;
  const auto all = [&] { return static_cast<std::size_t>(used) == text.size(); };
  const bool three = std::sscanf(text.c_str(), "%lf,%lf,%lf%n", &pitch, &height, &roll, &used) == 3 && all();
  if (!three) {
    roll = 0;
    const bool two = std::sscanf(text.c_str(), "%lf,%lf%n", &pitch, &height, &used) == 2 && all();
    if (!two) {
      throw UsageError("--table " + text + " is not none, file, estimate or PITCH_DEG,HEIGHT_M[,ROLL_DEG]",
                       "for example --table 40,0.8");
    }
  }
  if (!(pitch > -90 && pitch <= 90 && height > 0 && height < 50 && roll >= -180 && roll <= 180)) {
    throw UsageError("--table " + text + " is out of range",
                     "pitch -90..90 deg, height 0..50 m, roll -180..180 deg");
  }
  return TableGeometry::from_pitch_roll(pitch * kDegree, roll * kDegree, height);
}

}  // namespace

void DetectArguments::add_to(CLI::App& command) {
  command.add_option("models", models, "compiled models (.sxm)")->required();
  auto* set = command.add_option("--dataset", dataset, "BOP data set folder");
  command.add_option("--split", split, "of the data set")->capture_default_str();
  command.add_option("--scene", scene, "only this scene")->check(CLI::NonNegativeNumber);
  command.add_option("--image", image, "only this image number")->check(CLI::NonNegativeNumber);
  auto* colour_option =
      command.add_option("--color,--colour", colour, "single frame: colour image (PNG, JPEG)");
  auto* depth_option = command.add_option("--depth", depth, "single frame: 16-bit depth PNG");
  auto* camera_option = command.add_option("--camera", camera, "single frame: calibration YAML");
  colour_option->excludes(set)->needs(depth_option)->needs(camera_option);
  command.add_option("--csv", csv, "BOP results file to write");
  command.add_option("--overlay", overlay, "folder for pictures with outlines and axes");
  auto* proof_option =
      command.add_option("--proof", proof, "file for a certificate that `sextant verify` can check (slow)");
  command.add_option("--max-detections", detect.max_detections, "per object and image")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  command
      .add_option(
          "--candidates", detect.candidates,
          "most places searched and refined per object: while what is found is more likely wrong than "
          "right, the next best place is looked at; the most certain are reported. 1: only the best, "
          "which is all that --proof looks at")
      ->excludes(proof_option)
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  command.add_option("--threshold", threshold,
                     "log score that a detection must reach (default: 10 % of the evidence)");
  command.add_option("--deadline-ms", detect.deadline_ms, "time for the search of one image, 0: none")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command.add_option("--threads", detect.threads, "0: all cores")
      ->check(CLI::Range(0, 256))
      ->capture_default_str();
  command.add_option("--table", table, "none | file | estimate | PITCH_DEG,HEIGHT_M[,ROLL_DEG]")
      ->capture_default_str();
  command.add_option("--region", region,
                     "\"X Y WIDTH HEIGHT\": only poses whose centre is there in the image, pixels");
  command.add_option(
      "--workspace", workspace,
      "\"X0 X1 Y0 Y1 Z0 Z1\": only poses whose centre is there, metres; in the table's frame "
      "(origin below the camera, z up, x where the camera looks) unless --camera-pose is given");
  command.add_option("--camera-pose", camera_pose,
                     "\"X Y Z QX QY QZ QW\": the camera in the robot's frame, for --workspace");
  command.add_option("--height-tolerance-m", detect.tolerance.height_m, "of the table constraint")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command.add_option("--angle-tolerance-deg", angle_tolerance_deg, "of the table constraint")
      ->check(CLI::Range(0.0, 45.0))
      ->capture_default_str();
  command.add_option("--scoring", detect.scoring, "likelihood | thesis")->capture_default_str();
  command
      .add_option(
          "--bound", detect.bound,
          "lanes | window (its plain twin) | thesis (reference, one detection; give it a --deadline-ms)")
      ->capture_default_str();
  command
      .add_option("--search-width", detect.search_width, "width of the image that is searched, 0: as it is")
      ->capture_default_str();
  command.add_flag("!--no-refine", detect.refine, "keep the lattice poses; the score is the evidence share");
  command
      .add_option("--false-positive-rate", detect.false_positive_rate,
                  "wanted share of images with a false detection, for calibrated models; 1: report all")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command.add_option("--min-distance-m", detect.min_distance_m, "nearest object centre")
      ->capture_default_str();
  command.add_option("--max-distance-m", detect.max_distance_m, "farthest object centre")
      ->capture_default_str();
  command.add_flag("!--no-warm-start", detect.warm_start,
                   "do not begin with the last image's poses; the answer is the same");
  command.add_flag("--runner-up,!--no-runner-up", detect.runner_up,
                   "prove how much worse the best other explanation is, on by default");
  command.add_option("--runner-up-radius-m", detect.runner_up_radius_m, "other: farther from the pose, or")
      ->check(CLI::Range(0.0, 10.0))
      ->capture_default_str();
  command.add_option("--runner-up-angle-deg", runner_up_angle_deg, "other: turned by more (up to symmetry)")
      ->check(CLI::Range(0.0, 180.0))
      ->capture_default_str();
  command
      .add_option("--runner-up-most", detect.runner_up_most,
                  "a larger margin is only proven to be at least this, which is faster; inf: exactly")
      ->capture_default_str();
  command.add_flag("--json", json, "one JSON object per image");
  command.add_flag("--require", require, "exit 1 where an image has no detection");
}

DetectOptions DetectArguments::options() const {
  if (dataset.empty() && colour.empty()) {
    throw UsageError("nothing to look at", "give --dataset DIR, or --color F --depth F --camera FILE.yaml");
  }
  DetectOptions out = detect;
  if (!proof.empty()) out.candidates = 1;  // what is proven is what the score says is best
  out.threshold = threshold;
  out.region = region_from_text(region, workspace, camera_pose);
  out.tolerance.angle_rad = angle_tolerance_deg * kDegree;
  out.runner_up_angle_rad = runner_up_angle_deg * kDegree;
  if (table == "none") {
    out.table = TableSource::kNone;
  } else if (table == "file") {
    out.table = TableSource::kFrame;
  } else if (table == "estimate") {
    out.table = TableSource::kEstimate;
  } else {
    out.table = TableSource::kFixed;
    out.fixed_table = fixed_table(table);
  }
  return out;
}

}  // namespace sextant
