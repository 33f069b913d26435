// SPDX-License-Identifier: Apache-2.0
// What goes out beside poses - the objects' boxes and meshes - from the meshes inside the models.
#pragma once

#include <vector>

#include "runtime/model/object_model.h"
#include "runtime/publish/object_shape.h"

namespace sextant {

/// By object name, in the mesh's own frame. Models without a mesh are left out.
ObjectShapes object_shapes(const std::vector<ObjectModel>& models);

}  // namespace sextant
