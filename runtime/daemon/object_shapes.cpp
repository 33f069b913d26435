// SPDX-License-Identifier: Apache-2.0
#include "runtime/daemon/object_shapes.h"

#include <Eigen/Geometry>

namespace sextant {

ObjectShapes object_shapes(const std::vector<ObjectModel>& models) {
  ObjectShapes shapes;
  for (const ObjectModel& model : models) {
    const RigidTransform mesh_from_object = model.object_from_mesh.inverse();
    std::vector<Eigen::Vector3f> vertices;
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3f& vertex : model.mesh.vertices) {
      const Eigen::Vector3d p_in_mesh = mesh_from_object * vertex.cast<double>();
      box.extend(p_in_mesh);
      vertices.emplace_back(p_in_mesh.cast<float>());
    }
    if (box.isEmpty()) continue;
    ObjectShape& shape = shapes[model.name];
    shape.centre_m = box.center();
    shape.size_m = box.sizes();
    shape.corners.reserve(3 * model.mesh.triangles.size());
    for (const auto& triangle : model.mesh.triangles) {
      for (const std::uint32_t corner : triangle) shape.corners.push_back(vertices[corner]);
    }
  }
  return shapes;
}

}  // namespace sextant
