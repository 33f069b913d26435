// SPDX-License-Identifier: Apache-2.0
// The one mapping between the pose tuple and the rigid transform camera_from_object, used by the
// renderer, the table constraint and the publisher alike (Davies 2015, sec. 3.1; METHOD.md section 1).
//
// At a pixel with tangent coordinates (px, py), n = sqrt(1 + px^2 + py^2), the tangent frame of the
// viewing sphere is right = (1, 0, -px)/sqrt(1+px^2), forward = (px, py, 1)/n, down = forward x right.
// R_camera_from_object = [right down forward] * Rz(rx) * Rx(-ry) * B * Rz(rz), where B looks at the object
// from the front: object x -> right, y -> forward, z -> up.
#pragma once

#include "runtime/geometry/camera_model.h"
#include "runtime/geometry/pose6.h"
#include "runtime/geometry/rigid_transform.h"

namespace sextant {

/// Columns right, down, forward of the viewing sphere's tangent frame at pixel (x, y), in the camera frame.
Eigen::Matrix3d camera_from_tangent(const PinholeCamera& camera, double x, double y);

/// camera_from_object of a pose; the object frame has its origin in the centre of the bounding sphere.
RigidTransform transform_from_pose(const PinholeCamera& camera, const Pose6& pose);

/// Inverse of transform_from_pose; rx, rz in (-pi, pi], ry in [-pi/2, pi/2]. The translation must have Z > 0.
/// At ry = +-pi/2 only rx + rz or rx - rz is defined: rx is then 0.
Pose6 pose_from_transform(const PinholeCamera& camera, const RigidTransform& camera_from_object);

}  // namespace sextant
