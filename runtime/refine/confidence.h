// SPDX-License-Identifier: Apache-2.0
// The probability that a pose is right (within 1 cm and 15 deg), from what search and refinement found: a
// logistic regression whose features all grow with how good a pose looks and whose weights are never
// negative, so that better evidence cannot lower it. And the threshold for a wanted rate of false detections.
#pragma once

#include <array>

#include "runtime/model/confidence_model.h"
#include "runtime/refine/frame_result.h"

namespace sextant {

using ConfidenceFeatures = std::array<double, kConfidenceFeatures>;

/// Each in 0..1: share of the evidence that the search found; depth pixels on the surface of those that are
/// on or off it; outline found; object seen (neither occluded nor without depth); closeness of the inliers to
/// the surface; closeness of the refined pose to the certified one; print found.
ConfidenceFeatures confidence_features(const PoseEstimate& estimate);

/// In 0..1; rises with every feature. Uses the model's weights where it is calibrated, else the general ones.
double confidence(const ConfidenceModel& model, const ConfidenceFeatures& features);

/// Weights set by hand, for models that were not calibrated themselves: an ordering, not yet a probability.
const std::array<float, kConfidenceFeatures + 1>& general_confidence_weights();

/// What an answer of a model that was not calibrated must reach: below it none was right (docs/SCORING.md).
inline constexpr double kLeastGeneralConfidence = 0.05;

/// The confidence that a detection must reach so that at most this share (0..1) of images shows a false one:
/// exceeded on fewer than rate * (images + 1) of the calibration's images. 0 (all pass) where the rate is 1;
/// kLeastGeneralConfidence where the model is not calibrated; above 1 (none passes) where the calibration saw
/// too few images to promise so low a rate.
double threshold_for_false_positive_rate(const ConfidenceModel& model, double rate);

}  // namespace sextant
