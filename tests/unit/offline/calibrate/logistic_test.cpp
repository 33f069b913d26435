// SPDX-License-Identifier: Apache-2.0
#include "offline/calibrate/logistic.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace sextant {
namespace {

struct Examples {
  Eigen::MatrixXd rows;
  Eigen::VectorXd right;
};

/// Drawn from a logistic model with these weights (constant first).
Examples drawn(const Eigen::VectorXd& weights, int n, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  Examples e{Eigen::MatrixXd(n, weights.size() - 1), Eigen::VectorXd(n)};
  for (int i = 0; i < n; ++i) {
    double sum = weights[0];
    for (Eigen::Index k = 0; k < e.rows.cols(); ++k) {
      e.rows(i, k) = unit(random);
      sum += weights[k + 1] * e.rows(i, k);
    }
    e.right[i] = unit(random) < 1 / (1 + std::exp(-sum)) ? 1 : 0;
  }
  return e;
}

TEST(Logistic, FindsTheWeightsThatMadeTheExamples) {
  const Eigen::Vector3d truth(-3, 5, 1);
  const Examples e = drawn(truth, 20000, 1);
  const Eigen::VectorXd w = fit_logistic(e.rows, e.right, Eigen::Vector3d::Zero(), 1e-3);
  EXPECT_LT((w - truth).norm(), 0.3) << w.transpose();
}

TEST(Logistic, AFeatureThatWouldCountBackwardsGetsNothing) {
  const Examples e = drawn(Eigen::Vector3d(0, 3, -4), 5000, 2);
  const Eigen::VectorXd w = fit_logistic(e.rows, e.right, Eigen::Vector3d::Zero(), 1e-3);
  EXPECT_EQ(w[2], 0);
  EXPECT_GT(w[1], 1);
}

TEST(Logistic, FewExamplesStayNearThePrior) {
  const Examples e = drawn(Eigen::Vector3d(5, 0, 0), 5, 3);
  const Eigen::Vector3d prior(-2, 3, 1);
  const Eigen::VectorXd near = fit_logistic(e.rows, e.right, prior, 100);
  EXPECT_LT((near - prior).norm(), 0.1);
  const Eigen::VectorXd none = fit_logistic(Eigen::MatrixXd(0, 2), Eigen::VectorXd(0), prior, 1);
  EXPECT_LT((none - prior).norm(), 1e-9);
}

TEST(Logistic, SeparableExamplesGiveFiniteWeights) {
  Eigen::MatrixXd rows(4, 1);
  rows << 0, 0.1, 0.9, 1;
  const Eigen::VectorXd w = fit_logistic(rows, Eigen::Vector4d(0, 0, 1, 1), Eigen::Vector2d::Zero(), 0.05);
  EXPECT_TRUE(w.allFinite());
  EXPECT_GT(w[1], 1);
}

}  // namespace
}  // namespace sextant
