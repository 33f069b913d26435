// SPDX-License-Identifier: Apache-2.0
#include "offline/learn/least_squares.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace sextant {

LeastSquares::LeastSquares(std::size_t labels, std::array<bool, 4> active)
    : active_(active), btb_(labels, 0.0) {
  active_[0] = true;
  for (auto& row : atb_) row.assign(labels, 0.0);
}

void LeastSquares::add(const Eigen::Vector3d& rotation, std::span<const float> values) {
  if (values.size() != btb_.size()) throw std::logic_error("LeastSquares: wrong number of labels");
  Eigen::Vector4d a(1, rotation.x(), rotation.y(), rotation.z());
  for (int i = 0; i < 4; ++i) {
    if (!active_[static_cast<std::size_t>(i)]) a[i] = 0;
  }
  ata_ += a * a.transpose();
  ++examples_;
  for (std::size_t c = 0; c < 4; ++c) {
    const double weight = a[static_cast<Eigen::Index>(c)];
    double* row = atb_[c].data();
    for (std::size_t i = 0; i < values.size(); ++i) row[i] += weight * static_cast<double>(values[i]);
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    btb_[i] += static_cast<double>(values[i]) * static_cast<double>(values[i]);
  }
}

int LeastSquares::freedom() const {
  return examples_ - static_cast<int>(std::count(active_.begin(), active_.end(), true));
}

bool LeastSquares::finish() {
  Eigen::Matrix4d m = ata_;
  for (Eigen::Index i = 0; i < 4; ++i) {
    if (!active_[static_cast<std::size_t>(i)]) m(i, i) = 1;  // decouples the column; its A^T b is 0
  }
  const Eigen::FullPivLU<Eigen::Matrix4d> lu(m);
  if (!lu.isInvertible() || freedom() < 1) return false;
  inverse_ = lu.inverse();
  return true;
}

LinearFit LeastSquares::fit(std::size_t label) const {
  const Eigen::Vector4d b(atb_[0][label], atb_[1][label], atb_[2][label], atb_[3][label]);
  LinearFit out;
  out.coefficients = inverse_ * b;
  out.squared_error = std::max(
      0.0, out.coefficients.dot(ata_ * out.coefficients) - 2 * out.coefficients.dot(b) + btb_[label]);
  return out;
}

}  // namespace sextant
