// SPDX-License-Identifier: Apache-2.0
// How a model turns what search and refinement found into the probability that a pose is right: a logistic
// regression fitted on synthesised scenes (sextant calibrate), and the confidences that its false detections
// reached there, from which a threshold for a wanted false-positive rate follows.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace sextant {

/// What the regression sees. The names are those of runtime/refine/confidence.cpp.
inline constexpr std::size_t kConfidenceFeatures = 7;
inline constexpr std::size_t kMaxFalseConfidences = 4096;

struct ConfidenceModel {
  /// Of the constant, then of each feature; the program's general ones unless `calibrated`.
  std::array<float, kConfidenceFeatures + 1> weights{};
  bool calibrated = false;  ///< by scenes of this very object
  /// Of each image of the calibration on which something else was taken for the object: the confidence of the
  /// best such detection; falling.
  std::vector<float> false_confidences;
  int images = 0;  ///< of the calibration, with and without the object
};

}  // namespace sextant
