// SPDX-License-Identifier: Apache-2.0
// Rigid transforms are Eigen's isometries. Names read right to left: camera_from_object * p_in_object.
#pragma once

#include <Eigen/Geometry>

namespace sextant {

using RigidTransform = Eigen::Isometry3d;

/// Angle of the rotation between two transforms, radians, 0..pi.
double rotation_angle_between(const RigidTransform& a, const RigidTransform& b);

}  // namespace sextant
