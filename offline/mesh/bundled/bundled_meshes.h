// SPDX-License-Identifier: Apache-2.0
// The meshes that come with Sextant, made by this code: two cartons, a can, a tube, two bottles, a mug, a
// drill. data/meshes/ holds their files; sextant-make-meshes writes them again.
#pragma once

#include <map>
#include <string>

#include "offline/mesh/bundled/writers.h"

namespace sextant {

Mesh printed_box();   ///< millimetres, z up, base centre in the origin; 160 x 60 x 210
Mesh can();           ///< millimetres, z up, base centre in the origin; 66 across, 100 high
Mesh bottle();        ///< millimetres, z up, base centre in the origin; 248 high, handle towards +x
Mesh mug();           ///< millimetres, z up, base centre in the origin; 80 across, 92 high, handle towards +x
Mesh tea_box();       ///< millimetres, z up, base centre in the origin; 120 x 70 x 80
Mesh snack_tube();    ///< millimetres, z up, base centre in the origin; 78 across, 233.5 high
Mesh sauce_bottle();  ///< millimetres, z up, base centre in the origin; 62 across, 193 high
Mesh drill();         ///< millimetres, z up, stands on z = 0; 234 long towards +x, 189 high

/// File name -> content, all that data/meshes/ holds but its README. The same bytes at every call.
std::map<std::string, FileBytes> bundled_mesh_files();

}  // namespace sextant
