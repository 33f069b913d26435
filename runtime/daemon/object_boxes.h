// SPDX-License-Identifier: Apache-2.0
// The 3D boxes that go out with detections, from the meshes inside the models.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "runtime/model/object_model.h"
#include "runtime/publish/publisher.h"

namespace sextant {

/// By object name: the smallest box around the mesh along the axes of the mesh's own frame. Models without a
/// mesh are left out.
std::map<std::string, ObjectBox> object_boxes(const std::vector<ObjectModel>& models);

}  // namespace sextant
