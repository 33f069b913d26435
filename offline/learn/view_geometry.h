// SPDX-License-Identifier: Apache-2.0
// Where rendered views of a bin are taken from: what clean training views and test scenes share.
#pragma once

#include <opencv2/core.hpp>

#include "offline/learn/parameters.h"
#include "offline/render/renderer.h"
#include "offline/synthesize/random.h"
#include "runtime/geometry/pose6.h"
#include "runtime/model/object_model.h"

namespace sextant {

/// Square of the camera's image around the projected bounding sphere (its tangent cone, stretched by the
/// obliquity of the ray) and a border; may reach outside of the image.
cv::Rect window_around(const PinholeCamera& camera, const Pose6& pose, double radius_m, int border_px);

/// Random pose in the bin and in the camera's frustum (Davies 2015, Proc. 1).
Pose6 random_pose(const LearnParameters& parameters, const RotationBox& box, double radius_m, Random& random);

/// A lamp somewhere above the camera's half of the world.
Light random_light(const LearnParameters& parameters, const Pose6& pose, Random& random);

/// Frame of the table top under the object: z up, origin below the object's centre.
RigidTransform camera_from_table(const PinholeCamera& camera, const Pose6& pose, double centre_height_m);

/// A camera that looks up at the object's foot sees no table top.
bool table_is_seen(const Pose6& pose);

}  // namespace sextant
