// SPDX-License-Identifier: Apache-2.0
// Logistic regression with weights that are not negative (but for the constant) and are drawn towards given
// ones: few examples move them little, many decide.
#pragma once

#include <Eigen/Core>

namespace sextant {

/// rows: examples x features (without the constant); right: 0 or 1 per example. Minimises the log loss plus
/// strength / 2 * squared distance to `prior` (constant first), features' weights >= 0. Projected gradient
/// with a fixed step, which converges for this convex problem; deterministic.
Eigen::VectorXd fit_logistic(const Eigen::MatrixXd& rows, const Eigen::VectorXd& right,
                             const Eigen::VectorXd& prior, double strength);

}  // namespace sextant
