// SPDX-License-Identifier: Apache-2.0
// sextant verify: checks a proof that `sextant detect --proof` wrote.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "hal/playback/bop_dataset.h"
#include "hal/playback/single_frame.h"
#include "offline/cli/commands.h"
#include "offline/proof/fingerprint.h"
#include "offline/proof/proof_file.h"
#include "offline/proof/verify.h"
#include "runtime/base/error.h"
#include "runtime/model/model_file.h"

namespace sextant {
namespace {

struct VerifyArguments {
  std::filesystem::path proof;
  std::vector<std::filesystem::path> models;
  std::filesystem::path dataset;
  bool json = false;
};

std::vector<ObjectModel> read_models(const Proof& proof, const VerifyArguments& a) {
  if (!a.models.empty() && a.models.size() != proof.models.size()) {
    throw UsageError(fmt::format("--models: the proof is about {} models", proof.models.size()),
                     "give as many, in the same order");
  }
  std::vector<ObjectModel> models;
  for (std::size_t i = 0; i < proof.models.size(); ++i) {
    const std::filesystem::path file =
        a.models.empty() ? std::filesystem::path(proof.models[i].file) : a.models[i];
    const std::string hash = file_fingerprint(file);
    if (hash != proof.models[i].hash) {
      throw InputError(
          file.string(),
          fmt::format("is not the model of the proof (hash {}, not {})", hash, proof.models[i].hash),
          "give the same file with --models");
    }
    models.push_back(read_model(file));
  }
  return models;
}

/// The frames of a data set by their numbers, or the single frame.
class Frames {
 public:
  Frames(const Proof& proof, const VerifyArguments& a) : source_(proof.source) {
    if (!a.dataset.empty()) source_.dataset = a.dataset.string();
    if (!source_.dataset.empty()) set_ = open_bop_dataset(source_.dataset, source_.split);
  }
  RgbdFrame load(const FrameProof& frame) const {
    if (source_.dataset.empty()) return load_single_frame(source_.colour, source_.depth, source_.camera);
    for (const BopImage& image : set_.images) {
      if (image.scene_id == frame.scene_id && image.image_id == frame.image_id) return load_frame(image);
    }
    throw InputError(source_.dataset, fmt::format("no scene {} image {}", frame.scene_id, frame.image_id),
                     "give the data set of the proof with --dataset");
  }

 private:
  FrameSourceProof source_;
  BopDataset set_;
};

/// A code of its own: scripts must tell a false claim from a file that cannot be read.
constexpr int kClaimIsFalse = 5;

int run(const VerifyArguments& a) {
  const Proof proof = read_proof(a.proof);
  DetectOptions options = proof.options;
  options.threads = 1;
  options.bound = "window";
  Detector detector(read_models(proof, a), options);
  const Frames frames(proof, a);
  bool all = true;
  for (const FrameProof& frame : proof.frames) {
    for (const VerifiedObject& o :
         verify_frame(detector, proof, frame, frames.load(frame), a.proof.string())) {
      all = all && o.wrong.empty();
      if (a.json) {
        fmt::print("{}\n", nlohmann::ordered_json{{"scene_id", frame.scene_id},
                                                  {"im_id", frame.image_id},
                                                  {"object", o.name},
                                                  {"status", to_string(o.status)},
                                                  {"detections", o.detections},
                                                  {"boxes", o.boxes},
                                                  {"holds", o.wrong.empty()},
                                                  {"wrong", o.wrong}}
                               .dump());
      } else {
        fmt::print("scene {} image {}  {:<16} {} with {} detection{}: {}\n", frame.scene_id, frame.image_id,
                   o.name, to_string(o.status), o.detections, o.detections == 1 ? "" : "s",
                   o.wrong.empty() ? fmt::format("holds over all {} boxes", o.boxes) : "FALSE, " + o.wrong);
      }
      std::fflush(stdout);
    }
  }
  return all ? static_cast<int>(ExitCode::kDone) : kClaimIsFalse;
}

}  // namespace

CLI::App* add_verify_command(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<VerifyArguments>();
  CLI::App* command = app.add_subcommand("verify", "check a proof that `sextant detect --proof` wrote");
  command->footer(
      "Exit codes: 0 every claim holds, 5 one does not, 3 the proof, a model or a frame is not what it was.\n"
      "Example:\n  sextant detect mug.sxm --dataset data/sample --proof mug.proof\n"
      "  sextant verify mug.proof");
  command->add_option("proof", arguments->proof, "file to check")->required();
  command->add_option("--models", arguments->models, "the models, where they are not where the proof says");
  command->add_option("--dataset", arguments->dataset, "the data set, where it is not where the proof says");
  command->add_flag("--json", arguments->json, "one JSON object per claim");
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
  return command;
}

}  // namespace sextant
