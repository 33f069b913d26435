// SPDX-License-Identifier: Apache-2.0
#include "runtime/daemon/object_boxes.h"

#include <Eigen/Geometry>

namespace sextant {

std::map<std::string, ObjectBox> object_boxes(const std::vector<ObjectModel>& models) {
  std::map<std::string, ObjectBox> boxes;
  for (const ObjectModel& model : models) {
    const RigidTransform mesh_from_object = model.object_from_mesh.inverse();
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3f& vertex : model.mesh.vertices)
      box.extend(mesh_from_object * vertex.cast<double>());
    if (!box.isEmpty()) boxes[model.name] = {box.center(), box.sizes()};
  }
  return boxes;
}

}  // namespace sextant
