// SPDX-License-Identifier: Apache-2.0
#include "offline/learn/least_squares.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <random>

namespace sextant {
namespace {

// Five examples along rx only: b = 2 + 3 rx with residuals +1 -1 0 -1 +1 (orthogonal to 1 and rx), so the fit
// is exact and the squared error is 4.
TEST(LeastSquares, HandComputedLine) {
  LeastSquares sums(1, {true, true, false, false});
  const float residual[5] = {1, -1, 0, -1, 1};
  for (int i = 0; i < 5; ++i) {
    const double rx = i - 2;
    const float b = static_cast<float>(2 + 3 * rx) + residual[i];
    sums.add({rx, 99, -7}, std::span(&b, 1));
  }
  ASSERT_TRUE(sums.finish());
  const LinearFit fit = sums.fit(0);
  EXPECT_NEAR(fit.coefficients[0], 2, 1e-12);
  EXPECT_NEAR(fit.coefficients[1], 3, 1e-12);
  EXPECT_EQ(fit.coefficients[2], 0);
  EXPECT_EQ(fit.coefficients[3], 0);
  EXPECT_NEAR(fit.squared_error, 4, 1e-10);
  EXPECT_EQ(sums.freedom(), 3);
}

// The plain twin: all rows kept, solved by QR in double precision (eq. 4.1).
TEST(LeastSquares, AgreesWithThePlainTwin) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 1);
  constexpr int kLabels = 40;
  constexpr int kExamples = 60;
  LeastSquares sums(kLabels, {true, true, true, true});
  Eigen::MatrixXd a(kExamples, 4);
  Eigen::MatrixXd b(kExamples, kLabels);
  for (int i = 0; i < kExamples; ++i) {
    a.row(i) << 1, noise(random), -0.6 + 0.1 * noise(random), 2 + 0.1 * noise(random);
    std::vector<float> labels(kLabels);
    for (int k = 0; k < kLabels; ++k) {
      labels[static_cast<std::size_t>(k)] =
          static_cast<float>(0.05 * k + 0.1 * a(i, 1) - 0.02 * k * a(i, 3) + 0.01 * noise(random));
      b(i, k) = labels[static_cast<std::size_t>(k)];
    }
    sums.add({a(i, 1), a(i, 2), a(i, 3)}, labels);
  }
  ASSERT_TRUE(sums.finish());
  const Eigen::MatrixXd x = a.colPivHouseholderQr().solve(b);
  for (int k = 0; k < kLabels; ++k) {
    const LinearFit fit = sums.fit(static_cast<std::size_t>(k));
    EXPECT_LT((fit.coefficients - x.col(k)).norm(), 1e-8);
    EXPECT_NEAR(fit.squared_error, (a * x.col(k) - b.col(k)).squaredNorm(), 1e-8);
  }
}

TEST(LeastSquares, SaysWhenTheExamplesDoNotDetermineTheFit) {
  LeastSquares sums(1, {true, true, true, true});
  const float b = 1;
  for (int i = 0; i < 10; ++i) sums.add({1.0 * i, 2.0 * i, 0.5}, std::span(&b, 1));
  EXPECT_FALSE(sums.finish());
  LeastSquares few(1, {true, true, true, true});
  for (int i = 0; i < 4; ++i) few.add({1.0 * i, 1.0 * i * i, 1.0 * i * i * i}, std::span(&b, 1));
  EXPECT_FALSE(few.finish());  // no freedom left for a variance
}

}  // namespace
}  // namespace sextant
