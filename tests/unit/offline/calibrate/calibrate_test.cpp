// SPDX-License-Identifier: Apache-2.0
#include "offline/calibrate/calibrate.h"

#include <gtest/gtest.h>

#include <random>

#include "runtime/base/error.h"

namespace sextant {
namespace {

/// Detections whose chance of being right is known: it follows the edges' share alone.
ObjectObservations made(int images, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  ObjectObservations all;
  all.images = images;
  for (int i = 0; i < images; ++i) {
    Observation o;
    o.image = i;
    for (double& f : o.features) f = unit(random);
    o.right = unit(random) < 1 / (1 + std::exp(-12 * (o.features[2] - 0.5)));
    all.detections.push_back(o);
  }
  return all;
}

TEST(Calibrate, ConfidencesMeanWhatTheySayOnNewScenes) {
  const ObjectObservations learnt = made(400, 1);
  const ConfidenceModel model = calibrated(learnt, pooled_weights({learnt, made(400, 2)}), "box.sxm");
  EXPECT_TRUE(model.calibrated);
  EXPECT_GT(model.weights[3], 4 * model.weights[1]) << "only the edges' share told anything";
  const Reliability fresh = reliability(answers_of(model, made(4000, 3)));
  EXPECT_LT(fresh.expected_error, 0.05) << format_reliability(fresh);
}

TEST(Calibrate, TheThresholdKeepsItsPromiseOnNewScenes) {
  const ObjectObservations learnt = made(400, 4);
  const ConfidenceModel model = calibrated(learnt, pooled_weights({learnt}), "box.sxm");
  for (const double rate : {0.05, 0.1, 0.3}) {
    const double threshold = threshold_for_false_positive_rate(model, rate);
    const ObjectObservations fresh = made(5000, 5);
    int false_ones = 0;
    for (const Observation& o : fresh.detections) {
      false_ones += !o.right && confidence(model, o.features) >= threshold ? 1 : 0;
    }
    // Learnt from 400 scenes: two standard deviations of a share of 0.3 are 0.046.
    EXPECT_LT(false_ones / 5000.0, rate + 0.05);
    EXPECT_GT(false_ones / 5000.0, rate - 0.05);
  }
}

TEST(Calibrate, AFewDetectionsAreNoCalibration) {
  EXPECT_THROW(calibrated(made(10, 6), {}, "box.sxm"), InputError);
}

}  // namespace
}  // namespace sextant
