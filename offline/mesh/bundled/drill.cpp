// SPDX-License-Identifier: Apache-2.0
// A cordless drill that stands on its battery: the tool among the bundled objects. Vertex colours.
#include "offline/mesh/bundled/bundled_meshes.h"
#include "offline/mesh/bundled/shapes.h"

namespace sextant {

Mesh drill() {
  const Eigen::Vector3f orange(0.90F, 0.36F, 0.08F);
  const Eigen::Vector3f black(0.12F, 0.12F, 0.13F);
  const Eigen::Vector3f steel(0.66F, 0.67F, 0.70F);
  const Eigen::Vector3d y(0, 1, 0);
  Mesh mesh;
  // Tubes overlap where they meet, so that no gap is seen. The drill points towards +x.
  add_tube(mesh, {{-62, 0, 19}, {-58, 0, 19}, {42, 0, 19}, {46, 0, 19}}, 34, 19, y, 24, black);
  add_tube(mesh, {{-46, 0, 40}, {30, 0, 40}}, 30, 8, y, 24, orange);
  add_tube(mesh, {{-20, 0, 36}, {-16, 0, 80}, {-8, 0, 140}}, 17, 22, y, 20, black);
  add_tube(mesh, {{-78, 0, 158}, {-70, 0, 158}, {48, 0, 158}, {56, 0, 158}}, 29, 31, y, 28, orange);
  add_tube(mesh, {{-84, 0, 158}, {-76, 0, 158}}, 22, 24, y, 24, black);
  add_tube(mesh, {{54, 0, 160}, {84, 0, 160}}, 21, 21, y, 24, black);
  add_tube(mesh, {{82, 0, 160}, {104, 0, 160}}, 14, 14, y, 20, steel);
  add_tube(mesh, {{102, 0, 160}, {150, 0, 160}}, 3.5, 3.5, y, 10, steel);
  add_tube(mesh, {{12, 0, 118}, {6, 0, 96}}, 7, 6, y, 12, steel);  // trigger
  return mesh;
}

}  // namespace sextant
