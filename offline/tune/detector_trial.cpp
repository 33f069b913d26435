// SPDX-License-Identifier: Apache-2.0
#include "offline/tune/detector_trial.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>

#include "offline/dataset/bop_results.h"
#include "offline/dataset/models_info.h"
#include "offline/evaluate/evaluation.h"
#include "offline/evaluate/point_error.h"
#include "offline/learn/bin_layout.h"
#include "offline/learn/compile.h"
#include "runtime/base/error.h"
#include "runtime/base/version.h"
#include "runtime/model/model_file.h"

namespace sextant {
namespace {

constexpr std::size_t kMeshPoints = 800;

bool holds(const BopImage& image, int object_id) {
  return std::any_of(image.ground_truth.begin(), image.ground_truth.end(),
                     [&](const BopGt& gt) { return gt.object_id == object_id; });
}

EvaluatedObject evaluated(const StandingObject& object) {
  const ModelInfo info = measure_model(object);
  EvaluatedObject result;
  result.symmetry = symmetry_group_of(info, false);
  result.centre_m = info.centre_m();
  result.up = info.up.value_or(Eigen::Vector3d::UnitZ());
  result.diameter_m = info.diameter_m;
  const RigidTransform mesh_from_object = object.object_from_mesh.inverse();
  for (const Eigen::Vector3d& p : thinned(object.mesh.vertices, kMeshPoints))
    result.points.emplace_back(mesh_from_object * p);
  return result;
}

class DetectorTrial {
 public:
  explicit DetectorTrial(DetectorTrialOptions options)
      : options_(std::move(options)), evaluated_{{options_.object_id, evaluated(options_.object)}} {}

  TrialScore operator()(const TunePoint& point, Half half) const {
    const TuneParameters parameters = apply(options_.base, point);
    const std::vector<BopImage>& images =
        half == Half::kTraining ? options_.images.training : options_.images.held_out;
    DetectOptions detect = parameters.detect;
    detect.threads = options_.threads;
    std::vector<ObjectModel> models;
    models.push_back(model_for(parameters.learn));
    Detector detector(std::move(models), detect);
    std::vector<BopResult> results;
    double seconds = 0;
    for (const BopImage& image : images) {
      RgbdFrame frame = load_frame(image);
      frame.scene_id = image.scene_id;
      frame.image_id = image.image_id;
      const FrameResult result = detector.detect(frame);
      seconds += result.seconds.total;
      const auto rows = bop_results_of(result);
      results.insert(results.end(), rows.begin(), rows.end());
    }
    const ObjectReport report = evaluate(images, results, evaluated_, {}).objects.at(options_.object_id);
    TrialScore score;
    score.images = static_cast<int>(images.size());
    score.instances = report.instances;
    score.average_precision = report.average_precision.value_or(0);
    score.share_right = report.share_right();
    score.share_strict = report.share_strict();
    score.seconds = images.empty() ? 0 : seconds / static_cast<double>(images.size());
    return score;
  }

 private:
  /// Learnt, or read where another point with the same learning parameters has left it.
  ObjectModel model_for(const LearnParameters& learn) const {
    const std::string key = fmt::format("{} {} {:016x} {}", kProgramVersion, learn.to_yaml(),
                                        options_.object.file_hash, options_.object.symmetry_deg);
    const std::filesystem::path file =
        options_.folder / "models" / fmt::format("{:016x}.sxm", XXH3_64bits(key.data(), key.size()));
    std::error_code error;
    if (std::filesystem::exists(file, error)) return read_model(file);
    const auto boxes = lay_out_bins(learn, options_.object.symmetry_deg);
    ObjectModel model = assemble_model(options_.object, learn,
                                       learn_bins(options_.object, learn, boxes, options_.threads, 0, 1, {}),
                                       options_.mesh_name, options_.object_id);
    std::filesystem::create_directories(file.parent_path(), error);
    write_model(model, file);
    return read_model(file);
  }

  DetectorTrialOptions options_;
  std::map<int, EvaluatedObject> evaluated_;
};

}  // namespace

ImageHalves split_images(const std::vector<BopImage>& images, int object_id) {
  ImageHalves halves;
  std::size_t with = 0;
  std::size_t without = 0;
  for (const BopImage& image : images) {
    const std::size_t turn = holds(image, object_id) ? with++ : without++;
    (turn % 2 == 0 ? halves.training : halves.held_out).push_back(image);
  }
  return halves;
}

Trial detector_trial(DetectorTrialOptions options) {
  const bool any = std::any_of(options.images.training.begin(), options.images.training.end(),
                               [&](const BopImage& image) { return holds(image, options.object_id); });
  if (!any) {
    throw InputError("the training half", fmt::format("holds no object {}", options.object_id),
                     "see --object-id, and label at least two images");
  }
  const auto trial = std::make_shared<const DetectorTrial>(std::move(options));
  return [trial](const TunePoint& point, Half half) { return (*trial)(point, half); };
}

}  // namespace sextant
