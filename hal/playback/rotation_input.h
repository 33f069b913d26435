// SPDX-License-Identifier: Apache-2.0
// Rotation matrices from text files: rounded to a few digits, or nonsense.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

namespace sextant {

/// The rotation nearest to 9 numbers given row-wise; nothing where R R^T differs from the identity by more
/// than 0.02 in any element, or R mirrors.
std::optional<Eigen::Matrix3d> rotation_from_rounded(std::span<const double> row_wise);

}  // namespace sextant
