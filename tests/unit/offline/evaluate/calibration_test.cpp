// SPDX-License-Identifier: Apache-2.0
#include "offline/evaluate/calibration.h"

#include <gtest/gtest.h>

namespace sextant {
namespace {

TEST(Calibration, ExpectedErrorByHand) {
  // Bin 0.9..1: confidences 0.92, 0.98, both right: |1 - 0.95| = 0.05, 2 answers.
  // Bin 0.5..0.6: 0.5 wrong, 0.5 right: no error, 2 answers. Bin 0.1..0.2: 0.1 right: 0.9, 1 answer.
  const auto c = calibration({{0.92, true}, {0.98, true}, {0.5, false}, {0.5, true}, {0.1, true}});
  ASSERT_TRUE(c.has_value());
  EXPECT_NEAR((0.05 * 2 + 0 + 0.9) / 5, c->expected_error, 1e-12);
  EXPECT_EQ(2, c->bins[9].count);
  EXPECT_NEAR(0.95, c->bins[9].mean_confidence, 1e-12);
  EXPECT_EQ(2, c->bins[5].count);
  EXPECT_EQ(1, c->sure);
  EXPECT_EQ(1, c->share_sure_right);
}

TEST(Calibration, OneIsInTheLastBinAndScoresThatAreNoProbabilitiesHaveNone) {
  const auto c = calibration({{1.0, false}});
  ASSERT_TRUE(c.has_value());
  EXPECT_EQ(1, c->bins[9].count);
  EXPECT_EQ(1, c->expected_error);
  EXPECT_EQ(0, c->share_sure_right);
  EXPECT_FALSE(calibration({{0.5, true}, {12.0, true}}).has_value());
  EXPECT_FALSE(calibration({{-0.1, true}}).has_value());
  EXPECT_FALSE(calibration({}).has_value());
}

TEST(PrecisionRecallCurve, ByHand) {
  const auto curve = precision_recall_curve({{0.9, true}, {0.8, false}, {0.7, true}, {0.7, false}}, 4);
  ASSERT_EQ(3U, curve.size());
  EXPECT_EQ(1, curve[0].precision);
  EXPECT_EQ(0.25, curve[0].recall);
  EXPECT_EQ(0.5, curve[1].precision);
  EXPECT_EQ(0.5, curve[2].precision) << "equal scores make one point";
  EXPECT_EQ(0.5, curve[2].recall);
  EXPECT_TRUE(precision_recall_curve({{0.9, false}}, 0).empty());
}

}  // namespace
}  // namespace sextant
