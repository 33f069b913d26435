// SPDX-License-Identifier: Apache-2.0
#include "offline/mesh/bundled/bundled_meshes.h"

namespace sextant {

std::map<std::string, FileBytes> bundled_mesh_files() {
  const Mesh box = printed_box();
  const Mesh tea = tea_box();
  return {{"printed_box.obj", obj_bytes(box, "printed_box.mtl")},
          {"printed_box.mtl", mtl_bytes("printed_box.png")},
          {"printed_box.png", png_bytes(box.textures[0])},
          {"tea_box.obj", obj_bytes(tea, "tea_box.mtl")},
          {"tea_box.mtl", mtl_bytes("tea_box.png")},
          {"tea_box.png", png_bytes(tea.textures[0])},
          {"snack_tube.glb", glb_bytes(snack_tube(), 0.001)},
          {"sauce_bottle.glb", glb_bytes(sauce_bottle(), 0.001)},
          {"drill.ply", ply_bytes(drill())},
          {"can.glb", glb_bytes(can(), 0.001)},
          {"bottle.ply", ply_bytes(bottle())},
          {"mug.stl", stl_bytes(mug(), "mug of Sextant, millimetres, z up")}};
}

}  // namespace sextant
