// SPDX-License-Identifier: Apache-2.0
#include "offline/calibrate/logistic.h"

#include <algorithm>
#include <cmath>

namespace sextant {

Eigen::VectorXd fit_logistic(const Eigen::MatrixXd& rows, const Eigen::VectorXd& right,
                             const Eigen::VectorXd& prior, double strength) {
  const Eigen::Index n = rows.rows();
  Eigen::MatrixXd x(n, rows.cols() + 1);
  x.col(0).setOnes();
  x.rightCols(rows.cols()) = rows;
  // The loss curves by at most a quarter of the squared rows, plus the prior's strength.
  const double curvature = 0.25 * x.squaredNorm() + strength;
  const auto projected = [](Eigen::VectorXd w) {
    for (Eigen::Index i = 1; i < w.size(); ++i) w[i] = std::max(0.0, w[i]);
    return w;
  };
  Eigen::VectorXd w = projected(prior);
  Eigen::VectorXd ahead = w;
  double momentum = 1;
  // Accelerated (Beck & Teboulle 2009, FISTA).
  for (int round = 0; round < 20000; ++round) {
    const Eigen::VectorXd p = (1 + (-(x * ahead).array()).exp()).inverse();
    const Eigen::VectorXd gradient = x.transpose() * (p - right) + strength * (ahead - prior);
    const Eigen::VectorXd next = projected(ahead - gradient / curvature);
    const double step = (next - w).norm();
    const double faster = (1 + std::sqrt(1 + 4 * momentum * momentum)) / 2;
    ahead = next + ((momentum - 1) / faster) * (next - w);
    momentum = faster;
    w = next;
    if (step < 1e-10) break;
  }
  return w;
}

}  // namespace sextant
