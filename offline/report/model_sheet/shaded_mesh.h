// SPDX-License-Identifier: Apache-2.0
// The model's own mesh, flat-shaded in grey with a z-buffer: enough to judge where parts lie, and needs
// nothing but the model file. The mesh that a model carries is simplified; see offline/render for real
// pictures.
#pragma once

#include <opencv2/core.hpp>

#include "runtime/geometry/camera_model.h"
#include "runtime/geometry/rigid_transform.h"
#include "runtime/model/object_model.h"

namespace sextant {

/// Draws the mesh into `image` (CV_8UC3) as `camera` sees it, lit from the upper left. Both sides of a
/// triangle are drawn. Triangles that reach behind the camera are left out. Cost: triangles + painted pixels.
void draw_shaded_mesh(const ModelMesh& mesh, const PinholeCamera& camera,
                      const RigidTransform& camera_from_object, cv::Mat& image);

}  // namespace sextant
