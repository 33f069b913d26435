// SPDX-License-Identifier: Apache-2.0
// The rotations under which an object looks the same, and the rotation error that does not count them.
#pragma once

#include <optional>
#include <vector>

#include "offline/dataset/models_info.h"

namespace sextant {

/// Finite rotations times, optionally, one axis of full rotational symmetry; mesh frame.
struct SymmetryGroup {
  std::vector<Eigen::Matrix3d> rotations{Eigen::Matrix3d::Identity()};  ///< with the identity
  std::vector<Eigen::Vector3d> axes;  ///< unit; empty: no continuous symmetry

  /// Rotations about `up` by multiples of `degrees` (90, 180, 360); 0: all of them.
  static SymmetryGroup about(const Eigen::Vector3d& up, int degrees);
};

/// What models_info.json says: our key (with the print, or of the shape alone), else BOP's lists.
SymmetryGroup symmetry_group_of(const ModelInfo& info, bool geometric);

/// Smallest angle (radians) between an estimated and any equivalent true rotation camera_from_mesh. For a
/// continuous symmetry: the angle between the axes, which is what is left when the turn about the axis is
/// free.
double rotation_error_rad(const Eigen::Matrix3d& estimate, const Eigen::Matrix3d& truth,
                          const SymmetryGroup& group);

/// The part of the rotation error that a turntable under the object would make: signed angle (radians,
/// -pi..pi) about `up` (mesh frame), the one of least size over the group's finite rotations. Nothing where
/// every turn about `up` is a symmetry.
std::optional<double> turntable_error_rad(const Eigen::Matrix3d& estimate, const Eigen::Matrix3d& truth,
                                          const SymmetryGroup& group, const Eigen::Vector3d& up);

}  // namespace sextant
