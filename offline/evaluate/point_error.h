// SPDX-License-Identifier: Apache-2.0
// ADD and ADD-S (Hinterstoisser et al., "Model based training, detection and pose estimation of texture-less
// 3D objects in heavily cluttered scenes", ACCV 2012): mean distance of the mesh's points under two poses.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "runtime/geometry/rigid_transform.h"

namespace sextant {

/// Mean distance of corresponding points, metres.
double add_m(const std::vector<Eigen::Vector3d>& points, const RigidTransform& estimate,
             const RigidTransform& truth);

/// Mean distance of every true point to the nearest estimated one, metres (for objects that look alike from
/// several sides). O(n^2).
double add_s_m(const std::vector<Eigen::Vector3d>& points, const RigidTransform& estimate,
               const RigidTransform& truth);

/// At most `count` of the points, spread evenly over the list.
std::vector<Eigen::Vector3d> thinned(const std::vector<Eigen::Vector3f>& points, std::size_t count);

}  // namespace sextant
