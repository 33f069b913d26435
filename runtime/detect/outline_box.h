// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "runtime/geometry/camera_model.h"
#include "runtime/geometry/rigid_transform.h"
#include "runtime/model/object_model.h"

namespace sextant {

/// Pixel box of the object's outline in the source image: x, y, width, height. All 0 where it is behind the
/// camera. camera_from_object: of the object frame (bounding sphere's centre).
std::array<double, 4> outline_box(const ObjectModel& model, const CameraModel& camera,
                                  const RigidTransform& camera_from_object);

}  // namespace sextant
