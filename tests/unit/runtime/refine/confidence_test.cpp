// SPDX-License-Identifier: Apache-2.0
#include "runtime/refine/confidence.h"

#include <gtest/gtest.h>

#include "runtime/refine/refiner.h"

namespace sextant {
namespace {

PoseEstimate good() {
  PoseEstimate e;
  e.evidence_share = 0.8;
  e.refinement.refined = true;
  e.refinement.depth_inlier_share = 0.9;
  e.refinement.off_surface_share = 0.03;
  e.refinement.missing_share = 0.05;
  e.refinement.occluded_share = 0.02;
  e.refinement.edge_inlier_share = 0.8;
  e.refinement.outline_inlier_share = 0.85;
  e.refinement.mark_inlier_share = 0.6;
  e.refinement.depth_rms_m = 0.002;
  e.refinement.shift_m = 0.005;
  return e;
}

TEST(Confidence, BetterEvidenceNeverLowersIt) {
  const ConfidenceModel general;
  const ConfidenceFeatures features = confidence_features(good());
  for (const double f : features) {
    EXPECT_GE(f, 0);
    EXPECT_LE(f, 1);
  }
  for (std::size_t i = 0; i < features.size(); ++i) {
    ConfidenceFeatures better = features;
    better[i] = std::min(1.0, better[i] + 0.1);
    EXPECT_GE(confidence(general, better), confidence(general, features)) << i;
  }
  ConfidenceFeatures worst{};
  ConfidenceFeatures best;
  best.fill(1);
  EXPECT_LT(confidence(general, worst), 0.05);
  EXPECT_GT(confidence(general, best), 0.95);
}

TEST(Confidence, FeaturesFallWithWhatSpeaksAgainstThePose) {
  const ConfidenceFeatures before = confidence_features(good());
  PoseEstimate e = good();
  e.refinement.off_surface_share = 0.4;
  EXPECT_LT(confidence_features(e)[1], before[1]);
  e = good();
  e.refinement.occluded_share = 0.5;
  EXPECT_LT(confidence_features(e)[3], before[3]);
  e = good();
  e.refinement.left_neighbourhood = true;
  EXPECT_EQ(confidence_features(e)[5], 0);
  e = good();
  e.refinement.shift_m = Refiner::kMaxShiftM;
  EXPECT_EQ(confidence_features(e)[5], 0);
}

TEST(FalsePositiveRate, TheThresholdLeavesThatShareOfTheCalibrationsImages) {
  ConfidenceModel model;
  model.calibrated = true;
  model.images = 99;
  for (int i = 0; i < 60; ++i) model.false_confidences.push_back(0.9F - 0.01F * static_cast<float>(i));
  for (const double rate : {0.02, 0.05, 0.1, 0.25, 0.5}) {
    const double threshold = threshold_for_false_positive_rate(model, rate);
    int passing = 0;
    for (const float c : model.false_confidences) passing += c >= threshold ? 1 : 0;
    EXPECT_LE(passing, rate * model.images);
    EXPECT_GE(passing + 2, rate * model.images);
  }
  EXPECT_EQ(threshold_for_false_positive_rate(model, 1), 0);
  EXPECT_EQ(threshold_for_false_positive_rate(model, 0.7), 0) << "fewer images than that show a false one";
  EXPECT_GT(threshold_for_false_positive_rate(model, 0.001), 1)
      << "99 images cannot promise one in a thousand";
}

TEST(FalsePositiveRate, WithoutCalibrationNothingIsLeftOut) {
  EXPECT_EQ(threshold_for_false_positive_rate(ConfidenceModel{}, 0.01), kLeastGeneralConfidence);
  EXPECT_EQ(threshold_for_false_positive_rate(ConfidenceModel{}, 1), 0);
}

}  // namespace
}  // namespace sextant
