// SPDX-License-Identifier: Apache-2.0
#include "runtime/search/scored_bin.h"

#include <gtest/gtest.h>

#include "runtime/base/error.h"
#include "runtime/search/evaluate.h"

namespace sextant {
namespace {

constexpr auto kOneMetre = static_cast<std::int16_t>(1 / kLatticeDistance + 0.5);

/// A frame of 100 x 80 pixels, f = 100: flat depth 1 m along every ray, one vertical edge pixel at (60, 40).
struct TinyFrame {
  FrameTables tables;
  TinyFrame() {
    SearchFrame frame;
    frame.camera = {100, 80, 100, 50, 40};
    frame.ray_depth_m = cv::Mat(80, 100, CV_32FC1, cv::Scalar(1.0));
    frame.ray_depth_m.at<float>(40, 45) = 0;
    cv::Mat edges = cv::Mat::zeros(80, 100, CV_8UC1);
    edges.at<std::uint8_t>(40, 60) = 1U << 4;
    WorkerPool serial(1);
    tables.build(frame, edges, 50, serial);
  }
};

ObjectModel one_bin(VisualPart v, DepthPart d) {
  ObjectModel m;
  ViewpointBin bin;
  bin.box = {{0, 0, 0}, {1, 1, 1}};
  bin.visual = {v};
  bin.depth = {d};
  m.bins = {bin};
  return m;
}

// Eqs. 3.5 and 3.8 by hand.
TEST(Evaluate, IsTheThesisFormulaByHand) {
  const TinyFrame frame;
  VisualPart v;
  v.kind = 4;
  v.u[0] = 0.07F;  // expected pixel 50 + 100 * 0.07 = 57: 3 px from the edge; z = 1: 3 / 100 tangent metres
  v.radius = 0.05F;
  v.variance = 0.0004F;
  DepthPart d;
  d.px = 0.02F;
  d.d[0] = -0.012F;  // expected depth 0.988 where 1 is measured
  d.radius = 0.02F;
  d.variance = 0.0001F;
  d.missing = 0.01F;
  const LatticePose pose{0, {50, 40, kOneMetre, 0, 0, 0}};
  const auto bins = score_bins(one_bin(v, d), Scoring::kThesis);
  EXPECT_EQ(bins[0].offset, 0);
  EXPECT_NEAR(evaluate(bins[0], frame.tables, pose),
              -(0.03 * 0.03) / (2 * 0.0004) - (0.012 * 0.012) / (2 * 0.0001), 1e-3);

  v.u[0] = 0.0F;  // 10 px from the edge: beyond the receptive field
  d.px = -0.05F;  // the hole in the depth
  const auto missed = score_bins(one_bin(v, d), Scoring::kThesis);
  EXPECT_NEAR(evaluate(missed[0], frame.tables, pose),
              -(0.05 * 0.05) / (2 * 0.0004) - (0.01 * 0.01) / (2 * 0.0001), 1e-3);
  EXPECT_NEAR(missed[0].worst, -(0.05 * 0.05) / (2 * 0.0004) - (0.02 * 0.02) / (2 * 0.0001), 1e-3);
}

TEST(Likelihood, RewardsTheFoundAndPunishesTheAbsent) {
  const TinyFrame frame;
  VisualPart v;
  v.kind = 4;
  v.variance = 1e-6F;
  v.radius = 0.01F;
  DepthPart d;
  d.variance = 1e-6F;
  d.radius = 0.02F;
  d.missing = 0.01F;
  const LatticePose pose{0, {50, 40, kOneMetre, 0, 0, 0}};
  v.u[0] = 0.1F;
  const double both = evaluate(score_bins(one_bin(v, d), Scoring::kLikelihood)[0], frame.tables, pose);
  const auto perfect = score_bins(one_bin(v, d), Scoring::kLikelihood);
  EXPECT_NEAR(both, perfect[0].offset, 1e-4);
  EXPECT_GT(both, 0);
  EXPECT_NEAR(evidence_share(perfect[0], both), 1, 1e-4);
  d.d[0] = 0.3F;  // nothing at that depth, no edge there
  v.u[0] = -0.3F;
  const double none = evaluate(score_bins(one_bin(v, d), Scoring::kLikelihood)[0], frame.tables, pose);
  EXPECT_LT(none, 0);
  d.px = -0.05F;  // missing depth says nothing
  const double missing = evaluate(score_bins(one_bin(v, d), Scoring::kLikelihood)[0], frame.tables, pose);
  EXPECT_GT(missing, none);
}

TEST(Likelihood, WhatIsOutsideOfTheImageMayCountAsUnknown) {
  const TinyFrame frame;
  VisualPart v;
  v.kind = 4;
  v.variance = 1e-6F;
  v.radius = 0.01F;
  v.u[0] = -0.7F;  // 20 pixels left of the image
  DepthPart d;
  d.variance = 1e-6F;
  d.radius = 0.02F;
  const LatticePose pose{0, {50, 40, kOneMetre, 0, 0, 0}};
  ScoringOptions options;
  options.outside_is_unknown = false;
  const auto misses = score_bins(one_bin(v, d), options);
  options.outside_is_unknown = true;
  const auto unknown = score_bins(one_bin(v, d), options);
  // An unknown edge adds nothing to what the depth part says; a missed one takes some of it.
  ObjectModel alone = one_bin(v, d);
  alone.bins[0].visual.clear();
  const double depth = evaluate(score_bins(alone, options)[0], frame.tables, pose);
  EXPECT_NEAR(evaluate(unknown[0], frame.tables, pose), depth, 1e-5);
  EXPECT_LT(evaluate(misses[0], frame.tables, pose), depth - 0.5);
  // The thesis knows no such state.
  options.scoring = Scoring::kThesis;
  const auto thesis = score_bins(one_bin(v, d), options);
  EXPECT_EQ(thesis[0].visual.outside_cost[0], thesis[0].visual.radius2[0] * thesis[0].visual.weight[0]);
}

TEST(Likelihood, WhatStandsInFrontSaysLessThanWhatIsBehind) {
  const TinyFrame frame;
  DepthPart d;
  d.variance = 1e-6F;
  d.radius = 0.02F;
  const LatticePose pose{0, {50, 40, kOneMetre, 0, 0, 0}};
  const auto score = [&](float expected, const ScoringOptions& options) {
    d.d[0] = expected;  // the measured depth is 0
    ObjectModel model = one_bin({}, d);
    model.bins[0].visual.clear();
    return evaluate(score_bins(model, options)[0], frame.tables, pose);
  };
  ScoringOptions options;
  const double behind = score(-0.3F, options);   // the depth is farther than expected
  const double in_front = score(0.3F, options);  // nearer
  EXPECT_LT(behind, 0);
  EXPECT_NEAR(in_front, options.occluder_share * behind, 1e-5);
  EXPECT_NEAR(score(0.001F, options), score(-0.001F, options), 1e-4);  // on the surface there are no sides
  options.occluder_share = 1;
  EXPECT_NEAR(score(0.3F, options), behind, 1e-5);
  // The thesis takes both sides alike.
  options = Scoring::kThesis;
  EXPECT_EQ(score(0.3F, options), score(-0.3F, options));
}

TEST(Scoring, NamesAreChecked) {
  EXPECT_EQ(scoring_from_name("thesis"), Scoring::kThesis);
  EXPECT_EQ(scoring_from_name("likelihood"), Scoring::kLikelihood);
  EXPECT_THROW(scoring_from_name("magic"), UsageError);
}

}  // namespace
}  // namespace sextant
