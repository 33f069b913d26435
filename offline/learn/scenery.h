// SPDX-License-Identifier: Apache-2.0
// What stands around an object while it is learnt: table tops and clutter, made once per worker and kept in
// its renderer.
#pragma once

#include <vector>

#include "offline/render/renderer.h"
#include "offline/synthesize/random.h"

namespace sextant {

/// A thing that stands on the table: its axis is z, its foot z = 0.
struct SceneryThing {
  int mesh = 0;         ///< handle in the renderer
  double radius_m = 0;  ///< of its footprint
};

/// Uploaded meshes. The same for every worker, so that a model does not depend on their number.
struct Scenery {
  std::vector<int> plain_tables;     ///< one colour each: for the clean training views
  std::vector<int> textured_tables;  ///< for the scenes in which parts are measured
  std::vector<SceneryThing> things;

  explicit Scenery(Renderer& renderer);
};

}  // namespace sextant
