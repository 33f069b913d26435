// SPDX-License-Identifier: Apache-2.0
#include "offline/mesh/bundled/bundled_meshes.h"

namespace sextant {

std::map<std::string, FileBytes> bundled_mesh_files() {
  const Mesh box = printed_box();
  return {{"printed_box.obj", obj_bytes(box, "printed_box.mtl")},
          {"printed_box.mtl", mtl_bytes("printed_box.png")},
          {"printed_box.png", png_bytes(box.textures[0])},
          {"can.glb", glb_bytes(can(), 0.001)},
          {"bottle.ply", ply_bytes(bottle())},
          {"mug.stl", stl_bytes(mug(), "mug of Sextant, millimetres, z up")}};
}

}  // namespace sextant
