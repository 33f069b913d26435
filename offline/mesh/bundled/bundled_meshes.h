// SPDX-License-Identifier: Apache-2.0
// The meshes that come with Sextant, made by this code: a printed box, a can, a bottle with a handle, a mug.
// data/meshes/ holds their files; sextant-make-meshes writes them again.
#pragma once

#include <map>
#include <string>

#include "offline/mesh/bundled/writers.h"

namespace sextant {

Mesh printed_box();  ///< millimetres, z up, base centre in the origin; 160 x 60 x 210
Mesh can();          ///< millimetres, z up, base centre in the origin; 66 across, 100 high
Mesh bottle();       ///< millimetres, z up, base centre in the origin; 248 high, handle towards +x
Mesh mug();          ///< millimetres, z up, base centre in the origin; 80 across, 92 high, handle towards +x

/// File name -> content, all that data/meshes/ holds but its README. The same bytes at every call.
std::map<std::string, FileBytes> bundled_mesh_files();

}  // namespace sextant
