// SPDX-License-Identifier: Apache-2.0
#include "hal/playback/rotation_input.h"

#include <Eigen/LU>
#include <Eigen/SVD>

namespace sextant {

std::optional<Eigen::Matrix3d> rotation_from_rounded(std::span<const double> row_wise) {
  constexpr double kMaxError = 0.02;
  if (row_wise.size() != 9) return std::nullopt;
  const Eigen::Matrix3d r = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(row_wise.data());
  const double error = (r * r.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(error < kMaxError && r.determinant() > 0)) return std::nullopt;
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(r, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return svd.matrixU() * svd.matrixV().transpose();
}

}  // namespace sextant
