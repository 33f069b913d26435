// SPDX-License-Identifier: Apache-2.0
// Confidence from scenes with known truth: runs the detector over data sets, sees which detections are right,
// and fits the model's regression and its list of false detections.
#pragma once

#include <functional>
#include <vector>

#include "hal/playback/bop_dataset.h"
#include "offline/calibrate/reliability.h"
#include "runtime/detect/detector.h"
#include "runtime/refine/confidence.h"

namespace sextant {

/// One detection of one object.
struct Observation {
  int dataset = 0;
  int image = 0;          ///< number among all images looked at
  double confidence = 0;  ///< that the model gave
  bool right = false;
  ConfidenceFeatures features{};
};

/// What one object's model showed on all images.
struct ObjectObservations {
  std::vector<Observation> detections;
  int images = 0;
};

/// A pose is right within 1 cm (of the object's centre) and 15 deg of a true one, forgiving the model's
/// symmetry (with the print, or geometric). Detections of instances that lie (more than 20 deg off the
/// table's normal) or of which less than `min_visible` is seen are left out. `options`: false_positive_rate
/// is ignored (all detections count). progress(done, total) after each image.
std::vector<ObjectObservations> observe(const std::vector<ObjectModel>& models,
                                        const std::vector<BopDataset>& datasets, DetectOptions options,
                                        bool geometric, double min_visible,
                                        const std::function<void(std::size_t, std::size_t)>& progress);

/// Weights from the observations of several objects together.
std::array<float, kConfidenceFeatures + 1> pooled_weights(const std::vector<ObjectObservations>& all);

/// The calibration of one object: its own observations, drawn towards the pooled weights. Throws InputError
/// where there are fewer than 20 detections.
ConfidenceModel calibrated(const ObjectObservations& observed,
                           const std::array<float, kConfidenceFeatures + 1>& pooled, const std::string& name);

/// The answers a model would give on observations.
std::vector<Answer> answers_of(const ConfidenceModel& model, const ObjectObservations& observed);

}  // namespace sextant
