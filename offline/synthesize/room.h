// SPDX-License-Identifier: Apache-2.0
// What surrounds the table's clutter: the table itself with papers on it, floor, walls with pictures,
// furniture behind, lamps.
#pragma once

#include "offline/synthesize/scene.h"

namespace sextant {

/// Appends to scene.surroundings; scene.top must be set.
void add_room(TableScene& scene, TextureLibrary& textures, Random& random);

/// Lamps around `focus` (metres, world): one that casts shadows, up to two others, and the ambient level.
void add_lamps(TableScene& scene, const Eigen::Vector3d& focus, Random& random);

}  // namespace sextant
