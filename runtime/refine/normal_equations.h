// SPDX-License-Identifier: Apache-2.0
// Weighted least squares in normal form over the refinement's unknowns: a shift (m) of the object's centre, a
// small turn (rad) about it, both in the camera frame, and what all pixels of the object share: an offset of
// the depth and its two slopes (m, m per unit of tangent), a shift of the depth image (tangent units).
#pragma once

#include <Eigen/Core>
#include <array>

namespace sextant {

inline constexpr int kPoseUnknowns = 6;
inline constexpr int kSharedUnknowns = 5;
inline constexpr int kUnknowns = kPoseUnknowns + kSharedUnknowns;
inline constexpr int kWarpAt = 6;   ///< offset, slope in x, slope in y
inline constexpr int kShiftAt = 9;  ///< x, y

using State = Eigen::Matrix<double, kUnknowns, 1>;
using Information = Eigen::Matrix<double, kUnknowns, kUnknowns>;
using Shared = Eigen::Matrix<double, kSharedUnknowns, 1>;

/// Sum over observations of information * (residual - row . unknowns)^2.
struct NormalEquations {
  Information a = Information::Zero();  ///< lower triangle
  State b = State::Zero();

  /// Adds one observation whose row is 0 from unknown N on.
  template <int N>
  void add(const std::array<double, N>& row, double residual, double information) {
    for (int i = 0; i < N; ++i) {
      const double weighted = information * row[static_cast<std::size_t>(i)];
      b[i] += weighted * residual;
      for (int j = 0; j <= i; ++j) a(i, j) += weighted * row[static_cast<std::size_t>(j)];
    }
  }
  /// Adds another sum, times a factor.
  void add(const NormalEquations& other, double factor) {
    a += factor * other.a;
    b += factor * other.b;
  }
  Information full() const { return a.selfadjointView<Eigen::Lower>(); }
};

/// Tukey's weight of a residual of `ratio` gates (Holland & Welsch 1977).
inline double tukey_weight(double ratio) {
  const double r2 = ratio * ratio;
  return r2 >= 1 ? 0 : (1 - r2) * (1 - r2);
}

}  // namespace sextant
