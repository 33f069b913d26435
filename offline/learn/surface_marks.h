// SPDX-License-Identifier: Apache-2.0
// The print of an object as points in space: edges of colour that are neither silhouette nor crease, found in
// rendered views by the detector that the robot uses and put back onto the surface. The refinement matches
// them with the image, which tells what the shape alone does not (the turn of a labelled can).
#pragma once

#include <cstddef>
#include <vector>

#include "offline/mesh/standing_object.h"
#include "offline/render/renderer.h"
#include "runtime/model/object_model.h"

namespace sextant {

/// At most `max_marks` marks, spread over the surface; none for an object of one colour. `shape`: the model's
/// own mesh, whose creases count as shape, not print. Deterministic.
std::vector<SurfaceMark> find_surface_marks(Renderer& renderer, int mesh, const StandingObject& object,
                                            const ModelMesh& shape, std::size_t max_marks = 900);

}  // namespace sextant
