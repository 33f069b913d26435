// SPDX-License-Identifier: Apache-2.0
// sextant detect: poses for a BOP data set or a single frame.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>

#include "hal/image/image_file.h"
#include "hal/playback/bop_dataset.h"
#include "hal/playback/single_frame.h"
#include "offline/cli/commands.h"
#include "offline/cli/detect_command.h"
#include "offline/cli/detect_options.h"
#include "offline/cli/progress_bar.h"
#include "offline/dataset/bop_results.h"
#include "offline/dataset/result_json.h"
#include "offline/proof/proof_file.h"
#include "offline/proof/proof_writer.h"
#include "offline/report/overlay.h"
#include "runtime/base/error.h"
#include "runtime/model/model_file.h"

namespace sextant {
namespace {

void print_text(const FrameResult& r) {
  fmt::print(
      "scene {} image {}: features {:.1f} ms, tables {:.1f} ms, search {:.1f} ms, refine {:.1f} ms, {} "
      "nodes\n",
      r.scene_id, r.image_id, r.seconds.features * 1e3, r.seconds.tables * 1e3, r.seconds.search * 1e3,
      r.seconds.refine * 1e3, r.nodes);
  for (const PoseEstimate& e : r.estimates) {
    const Eigen::Vector3d t = e.camera_from_object.translation();
    fmt::print(
        "  {:<16} score {:.2f}  log {:8.1f}  gap {:.1f}  {}  at ({:+.4f}, {:+.4f}, {:.4f}) m +- {:.1f} "
        "mm{}\n",
        e.object_name, e.score, e.log_score, e.gap, to_string(e.status), t.x(), t.y(), t.z(),
        1e3 * std::sqrt(e.covariance.topLeftCorner<3, 3>().trace()),
        e.refinement.left_neighbourhood ? "  (refinement left the neighbourhood: lattice pose)"
        : e.refinement.other_turn       ? "  (turned: scores less, fits the picture better)"
                                        : "");
  }
  for (const ObjectOutcome& o : r.objects) {
    if (o.status == SearchStatus::kAbsent) {
      fmt::print("  {:<16} absent: no pose reaches {:.1f}\n", o.object_name, o.threshold);
    }
    const bool found = std::any_of(r.estimates.begin(), r.estimates.end(),
                                   [&](const PoseEstimate& e) { return e.object_id == o.object_id; });
    if (o.status == SearchStatus::kBounded && !found) {
      fmt::print("  {:<16} bounded: the deadline came first; no pose scores above {:.1f}\n", o.object_name,
                 o.upper_bound);
    }
    if (o.doubtful > 0) {
      fmt::print("  {:<16} {} less certain than {:.2f} left out (--false-positive-rate)\n", o.object_name,
                 o.doubtful, o.least_confidence);
    }
    if (o.coverage < 0.999) {
      fmt::print(
          "  {:<16} the model's bins cover {:.0f} % of what this camera can see: compile with a wider "
          "--pitch-deg\n",
          o.object_name, o.coverage * 100);
    }
  }
}

void write_overlay(const std::filesystem::path& folder, const RgbdFrame& frame, const FrameResult& result,
                   const std::vector<ObjectModel>& models) {
  std::filesystem::create_directories(folder);
  write_png(folder / fmt::format("{:06d}_{:06d}.png", result.scene_id, result.image_id),
            draw_overlay(frame, result, models));
}

/// Every frame asked for, in order.
void for_each_frame(const DetectArguments& a, const std::function<void(const RgbdFrame&)>& visit) {
  if (!a.colour.empty()) {
    visit(load_single_frame(a.colour, a.depth, a.camera));
    return;
  }
  const BopDataset set = open_bop_dataset(a.dataset, a.split, a.scene);
  ProgressBar bar("images");
  std::size_t done = 0;
  bool any = false;
  for (const BopImage& image : set.images) {
    ++done;
    if (a.image >= 0 && image.image_id != a.image) continue;
    any = true;
    RgbdFrame frame = load_frame(image);
    frame.scene_id = image.scene_id;
    frame.image_id = image.image_id;
    visit(frame);
    bar.show(done, set.images.size());
  }
  if (!any)
    throw InputError(a.dataset.string(), fmt::format("no image {}", a.image), "see --scene and --image");
}

}  // namespace

ExitCode run_detect(const DetectArguments& a, const BeforeDetect& before) {
  std::vector<ObjectModel> models;
  for (const auto& file : a.models) models.push_back(read_model(file));
  const DetectOptions options = a.options();
  Detector detector(std::move(models), options);
  std::optional<ProofWriter> proof;
  if (!a.proof.empty()) {
    proof.emplace(a.models, detector.models(), options,
                  FrameSourceProof{a.dataset, a.split, a.colour, a.depth, a.camera});
  }
  std::vector<BopResult> rows;
  bool missing = false;
  for_each_frame(a, [&](const RgbdFrame& frame) {
    DetectCall call;
    if (proof) call.searched = [&](const SearchRecord& record) { proof->add(frame, record); };
    if (before) before(frame, call);
    const FrameResult result = detector.detect(frame, call);
    missing = missing || result.estimates.empty();
    if (a.json) {
      fmt::print("{}\n", format_result_json(result));
    } else {
      print_text(result);
    }
    if (!a.overlay.empty()) write_overlay(a.overlay, frame, result, detector.models());
    const auto found = bop_results_of(result);
    rows.insert(rows.end(), found.begin(), found.end());
  });
  if (!a.csv.empty()) write_bop_results(a.csv, rows);
  if (proof) write_proof(a.proof, proof->proof());
  return a.require && missing ? ExitCode::kNothingFound : ExitCode::kDone;
}

CLI::App* add_detect_command(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<DetectArguments>();
  CLI::App* command = app.add_subcommand("detect", "poses for a BOP data set or a single frame");
  command->footer(
      "Examples:\n  sextant detect mug.sxm --dataset data/sample --overlay out\n"
      "  sextant detect mug.sxm --color c.png --depth d.png --camera cam.yaml --table estimate");
  arguments->add_to(*command);
  command->callback([arguments, &exit_code] { exit_code = static_cast<int>(run_detect(*arguments)); });
  return command;
}

}  // namespace sextant
