// SPDX-License-Identifier: Apache-2.0
// Where an object's weight is, taken as a solid of one density.
#pragma once

#include "offline/mesh/convex_hull.h"
#include "offline/mesh/mesh.h"

namespace sextant {

/// Centre of mass: by signed volumes where the mesh is (nearly) closed and encloses something, else the
/// centre of its hull's volume. Nearly closed: the free edges are together shorter than a quarter of the
/// hull's mean radius. The sign of the volume does not matter (a mesh may be inside out).
Eigen::Vector3d centre_of_mass(const Mesh& mesh, const ConvexHull& hull);

/// Length of all edges that are not shared by two triangles which turn the same way, metres.
/// Corners with exactly equal coordinates are one.
double free_edge_length(const Mesh& mesh);

}  // namespace sextant
