// SPDX-License-Identifier: Apache-2.0
#include "runtime/search/part_likelihood.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sextant {
namespace {

TEST(PartLikelihood, FoundSpeaksForAbsentSpeaksAgainst) {
  const PartLikelihood l = likelihood_of({1e-6F, 0.9F, 0.2F, 1}, 1);
  EXPECT_GT(l.gain, std::log(0.9 / 0.2));
  EXPECT_NEAR(l.out, std::log(0.1 / 0.8), 1e-6);
  EXPECT_EQ(l.at(0, 1e-6), l.gain);
  EXPECT_EQ(l.at(1, 1e-6), l.out);
  EXPECT_NEAR(l.at(4e-6, 1e-6), l.gain - 2, 1e-9);
}

// Within the gate the ratio of densities integrates to the ratio of the shares.
TEST(PartLikelihood, IsARatioOfDensities) {
  const PartStatistics seen{1, 0.8F, 0.25F, 1};
  for (const int dimensions : {1, 2}) {
    const PartLikelihood l = likelihood_of(seen, dimensions);
    double on_object = 0;
    double on_background = 0;
    constexpr double kStep = 0.001;
    for (double d = kStep / 2; d < kFoundSigmas; d += kStep) {
      const double measure = dimensions == 1 ? 1 : d;
      on_object += measure * std::exp(l.gain - d * d / 2);
      on_background += measure;
    }
    // The normal distribution loses its tails beyond the gate: 1.2 % in one dimension, 4.4 % in two.
    EXPECT_NEAR(on_object / on_background * 0.25, 0.8, 0.045) << dimensions;
  }
}

TEST(PartLikelihood, WhatIsAsCommonByChanceNeverSpeaksAgainst) {
  const PartLikelihood l = likelihood_of({1, 0.3F, 0.6F, 1}, 1);
  EXPECT_NEAR(l.out, 0, 1e-6);
}

}  // namespace
}  // namespace sextant
