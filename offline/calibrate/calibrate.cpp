// SPDX-License-Identifier: Apache-2.0
#include "offline/calibrate/calibrate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "offline/calibrate/logistic.h"
#include "offline/evaluate/symmetry_group.h"
#include "runtime/base/error.h"

namespace sextant {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kRightShiftM = 0.01;
constexpr double kRightTurnRad = 15 * kDegree;
constexpr double kUprightCosine = 0.94;  // 20 deg
constexpr std::size_t kFewestDetections = 20;
/// Weight of the general weights against an object's own examples, and of theirs against nothing.
constexpr double kPriorStrength = 0.5;
constexpr double kPooledStrength = 0.05;

enum class Verdict : std::uint8_t { kWrong, kRight, kIgnored };

/// What the truth says of one detection.
Verdict judge(const ObjectModel& model, const PoseEstimate& estimate, const BopImage& image, bool geometric,
              double min_visible) {
  const RigidTransform mesh_from_object = model.object_from_mesh.inverse();
  const SymmetryGroup symmetry = SymmetryGroup::about(
      Eigen::Vector3d::UnitZ(), geometric ? model.geometric_symmetry_deg : model.symmetry_deg);
  const RigidTransform pose = estimate.camera_from_object * mesh_from_object;
  Verdict verdict = Verdict::kWrong;
  for (const BopGt& gt : image.ground_truth) {
    if (gt.object_id != model.object_id) continue;
    const RigidTransform truth = gt.camera_from_mesh * mesh_from_object;
    const double shift = (truth.translation() - pose.translation()).norm();
    const bool lies = image.table && truth.linear().col(2).dot(image.table->up_in_camera) < kUprightCosine;
    if (lies || gt.visible_fraction.value_or(1) < min_visible) {
      if (shift < 2 * model.bounding_radius_m && verdict == Verdict::kWrong) verdict = Verdict::kIgnored;
      continue;
    }
    const double turn = rotation_error_rad(pose.linear(), truth.linear(), symmetry);
    if (shift <= kRightShiftM && turn <= kRightTurnRad) return Verdict::kRight;
  }
  return verdict;
}

Eigen::MatrixXd rows_of(const std::vector<const Observation*>& observations) {
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(observations.size()),
                       static_cast<Eigen::Index>(kConfidenceFeatures));
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    for (Eigen::Index k = 0; k < rows.cols(); ++k) {
      rows(i, k) = observations[static_cast<std::size_t>(i)]->features[static_cast<std::size_t>(k)];
    }
  }
  return rows;
}

std::array<float, kConfidenceFeatures + 1> fit(const std::vector<const Observation*>& observations,
                                               const std::array<float, kConfidenceFeatures + 1>& prior,
                                               double strength) {
  Eigen::VectorXd right(static_cast<Eigen::Index>(observations.size()));
  for (Eigen::Index i = 0; i < right.size(); ++i) {
    right[i] = observations[static_cast<std::size_t>(i)]->right ? 1 : 0;
  }
  Eigen::VectorXd start(static_cast<Eigen::Index>(prior.size()));
  for (std::size_t i = 0; i < prior.size(); ++i) start[static_cast<Eigen::Index>(i)] = prior[i];
  const Eigen::VectorXd w = fit_logistic(rows_of(observations), right, start, strength);
  std::array<float, kConfidenceFeatures + 1> weights{};
  for (std::size_t i = 0; i < weights.size(); ++i) {
    weights[i] = static_cast<float>(w[static_cast<Eigen::Index>(i)]);
  }
  return weights;
}

}  // namespace

std::vector<ObjectObservations> observe(const std::vector<ObjectModel>& models,
                                        const std::vector<BopDataset>& datasets, DetectOptions options,
                                        bool geometric, double min_visible,
                                        const std::function<void(std::size_t, std::size_t)>& progress) {
  options.false_positive_rate = 1;
  options.refine = true;
  options.candidates = 1;  // all places that are looked at count, whatever the present confidence says
  std::size_t total = 0;
  for (const BopDataset& set : datasets) total += set.images.size();
  Detector detector(models, options);
  std::vector<ObjectObservations> all(models.size());
  std::size_t done = 0;
  for (std::size_t d = 0; d < datasets.size(); ++d) {
    for (const BopImage& image : datasets[d].images) {
      RgbdFrame frame = load_frame(image);
      frame.image_id = image.image_id;
      const FrameResult result = detector.detect(frame);
      for (const PoseEstimate& e : result.estimates) {
        const ObjectModel& model = models[e.model_index];
        const Verdict verdict = judge(model, e, image, geometric, min_visible);
        if (verdict == Verdict::kIgnored) continue;
        all[e.model_index].detections.push_back({static_cast<int>(d), static_cast<int>(done), e.score,
                                                 verdict == Verdict::kRight, confidence_features(e)});
      }
      ++done;
      for (ObjectObservations& o : all) ++o.images;
      if (progress) progress(done, total);
    }
  }
  return all;
}

std::array<float, kConfidenceFeatures + 1> pooled_weights(const std::vector<ObjectObservations>& all) {
  std::vector<const Observation*> every;
  for (const ObjectObservations& one : all) {
    for (const Observation& o : one.detections) every.push_back(&o);
  }
  return fit(every, {}, kPooledStrength);
}

ConfidenceModel calibrated(const ObjectObservations& observed,
                           const std::array<float, kConfidenceFeatures + 1>& pooled,
                           const std::string& name) {
  if (observed.detections.size() < kFewestDetections) {
    throw InputError(name,
                     fmt::format("the data sets gave {} detections, fewer than {}",
                                 observed.detections.size(), kFewestDetections),
                     "calibrate with more images, or lower --threshold");
  }
  std::vector<const Observation*> own;
  for (const Observation& o : observed.detections) own.push_back(&o);
  ConfidenceModel model;
  model.weights = fit(own, pooled, kPriorStrength);
  model.calibrated = true;
  model.images = observed.images;
  std::map<int, double> worst;  ///< by image: the surest wrong detection
  for (const Observation& o : observed.detections) {
    if (o.right) continue;
    double& c = worst.try_emplace(o.image, 0).first->second;
    c = std::max(c, confidence(model, o.features));
  }
  for (const auto& [image, c] : worst) model.false_confidences.push_back(static_cast<float>(c));
  std::sort(model.false_confidences.rbegin(), model.false_confidences.rend());
  if (model.false_confidences.size() > kMaxFalseConfidences) {
    model.false_confidences.resize(kMaxFalseConfidences);
  }
  return model;
}

std::vector<Answer> answers_of(const ConfidenceModel& model, const ObjectObservations& observed) {
  std::vector<Answer> answers;
  for (const Observation& o : observed.detections)
    answers.push_back({confidence(model, o.features), o.right});
  return answers;
}

}  // namespace sextant
