// SPDX-License-Identifier: Apache-2.0
#include "runtime/refine/confidence.h"

#include <algorithm>
#include <cmath>

#include "runtime/refine/refiner.h"

namespace sextant {
namespace {

constexpr double kRmsScaleM = 0.008;

double share(double part, double rest) { return part + rest > 0 ? part / (part + rest) : 0.5; }

}  // namespace

ConfidenceFeatures confidence_features(const PoseEstimate& estimate) {
  const Refinement& r = estimate.refinement;
  const auto unit = [](double v) { return std::clamp(v, 0.0, 1.0); };
  return {unit(estimate.evidence_share),
          unit(share(r.depth_inlier_share, r.off_surface_share)),
          unit(r.outline_inlier_share),
          unit(1 - r.missing_share - r.occluded_share),
          unit(1 - r.depth_rms_m / kRmsScaleM),
          r.left_neighbourhood ? 0 : unit(1 - r.shift_m / Refiner::kMaxShiftM),
          unit(r.mark_inlier_share)};
}

const std::array<float, kConfidenceFeatures + 1>& general_confidence_weights() {
  // The mean of two fits: to the answers for four bundled objects in 300 synthesised images of three sensors,
  // and to those for the five models without print in the Kinect frames of mOSD (docs/BENCHMARKS.md).
  // `sextant calibrate` fits a model's own.
  static constexpr std::array<float, kConfidenceFeatures + 1> kWeights{-20.0F, 3.95F, 4.85F, 4.97F,
                                                                       3.1F,   0,     0.67F, 14.93F};
  return kWeights;
}

double confidence(const ConfidenceModel& model, const ConfidenceFeatures& features) {
  const auto& weights = model.calibrated ? model.weights : general_confidence_weights();
  double sum = weights[0];
  for (std::size_t i = 0; i < kConfidenceFeatures; ++i) {
    sum += static_cast<double>(weights[i + 1]) * features[i];
  }
  return 1 / (1 + std::exp(-sum));
}

double threshold_for_false_positive_rate(const ConfidenceModel& model, double rate) {
  if (rate >= 1) return 0;
  if (!model.calibrated) return kLeastGeneralConfidence;
  // Of n images at most k may exceed the threshold; one more is counted for the image to come, so that the
  // promise also holds on average for new ones (split conformal prediction, Vovk et al. 2005).
  const double allowed = std::floor(rate * (model.images + 1)) - 1;
  if (allowed < 0) return 1.001;
  const auto k = static_cast<std::size_t>(allowed);
  if (k >= model.false_confidences.size()) return 0;
  return std::nextafter(static_cast<double>(model.false_confidences[k]), 2.0);
}

}  // namespace sextant
