// SPDX-License-Identifier: Apache-2.0
// A coarser copy of a mesh for the model file (overlays, refinement).
#pragma once

#include <cstddef>

#include "offline/mesh/mesh.h"
#include "runtime/model/object_model.h"

namespace sextant {

/// Collapses edges in the order of their quadric error (Garland and Heckbert 1997, "Surface simplification
/// using quadric error metrics") until at most `max_triangles` are left. A collapse that would fold the
/// surface over or pinch it is left out; if too many are, the rest is done by vertex clustering on the
/// finest grid that suffices. Corners with exactly equal coordinates are one vertex; colours are dropped;
/// degenerate triangles go. Never returns more than max_triangles (at least 4). Deterministic.
/// O(n log n): about half a minute for 2,000,000 triangles.
ModelMesh simplified(const Mesh& mesh, std::size_t max_triangles);

/// The coarsest of a few simplifications (at most max_triangles, and halves, quarters, ... of it down to 200)
/// that stays within tolerance_m of the mesh (surface_distance_m); the finest where none does. A box becomes
/// its twelve triangles however finely it was cut, and refinement costs the less.
ModelMesh simplified_within(const Mesh& mesh, double tolerance_m, std::size_t max_triangles);

/// The largest distance between two surfaces, both ways, at `samples` points spread over each and at all
/// vertices (a sampled Hausdorff distance), metres.
double surface_distance_m(const Mesh& mesh, const ModelMesh& other, std::size_t samples = 20000);

}  // namespace sextant
