// SPDX-License-Identifier: Apache-2.0
// Incremental least squares of many labels against one set of examples (Davies 2015, Procs. 2-5): A^T A is
// the same for all labels and stored once (the thesis's footnote 1 of sec. 4.1.2); per label only A^T b and
// b^T b.
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

namespace sextant {

/// Coefficients of (1, rx, ry, rz) for one label, and its residual variance (eqs. 4.2, 4.3).
struct LinearFit {
  Eigen::Vector4d coefficients = Eigen::Vector4d::Zero();
  double squared_error = 0;  ///< sum over the examples
};

/// Sums over the training examples of one bin for `labels` scalars at once.
class LeastSquares {
 public:
  /// active: which of (1, rx, ry, rz) may have a coefficient; the first always.
  LeastSquares(std::size_t labels, std::array<bool, 4> active);

  /// Adds one example: its rotation and the value of every label.
  void add(const Eigen::Vector3d& rotation, std::span<const float> values);

  int examples() const { return examples_; }
  /// Degrees of freedom left for the variance: examples - number of active columns.
  int freedom() const;
  /// Inverts A^T A (once, for all labels). Returns false where the examples do not determine the fit.
  bool finish();
  /// Fit of one label; call finish() first.
  LinearFit fit(std::size_t label) const;

 private:
  std::array<bool, 4> active_;
  int examples_ = 0;
  Eigen::Matrix4d ata_ = Eigen::Matrix4d::Zero();
  Eigen::Matrix4d inverse_ = Eigen::Matrix4d::Zero();
  std::array<std::vector<double>, 4> atb_;
  std::vector<double> btb_;
};

}  // namespace sextant
