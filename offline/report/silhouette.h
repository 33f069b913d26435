// SPDX-License-Identifier: Apache-2.0
// The silhouette of a posed mesh in an image: its triangles, projected with the full camera model and filled.
#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "runtime/geometry/camera_model.h"
#include "runtime/geometry/rigid_transform.h"
#include "runtime/model/object_model.h"

namespace sextant {

/// CV_8UC1 mask (255 = object) of `scale` times the camera's size. Triangles that reach closer than 2 cm to
/// the focal plane are left out. Throws std::invalid_argument where a triangle names a vertex that is not
/// there.
cv::Mat silhouette_mask(const ModelMesh& mesh, const CameraModel& camera,
                        const RigidTransform& camera_from_model, int scale = 1);

/// Pixel of a point in an image enlarged by `scale` (pixel centres are integers in both); nothing behind or
/// within 2 cm of the focal plane.
std::optional<cv::Point2d> project_scaled(const CameraModel& camera, const Eigen::Vector3d& p_in_camera,
                                          int scale);

}  // namespace sextant
