// SPDX-License-Identifier: Apache-2.0
// Surface normals for meshes that bring none.
#pragma once

#include "offline/mesh/mesh.h"

namespace sextant {

/// Facets that meet at less than this angle are shaded as one smooth surface, degrees.
inline constexpr double kCreaseDeg = 40;

/// Gives every vertex whose normal is zero or not a number the mean of the facets around its position,
/// weighted by their angle there, over the facets that lie within kCreaseDeg of the vertex's own one;
/// vertices on a crease are split. Facets meet where their corners have exactly equal coordinates.
/// All normals have unit length afterwards.
void complete_normals(Mesh& mesh);

/// Makes vertices that agree in position, normal, colour and texture coordinates one.
void share_equal_vertices(Mesh& mesh);

/// For every vertex the index of the first vertex with exactly the same coordinates.
std::vector<std::uint32_t> welded_indices(const std::vector<Eigen::Vector3f>& vertices);

}  // namespace sextant
