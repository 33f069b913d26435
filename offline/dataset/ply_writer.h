// SPDX-License-Identifier: Apache-2.0
// Meshes as BOP keeps them: binary PLY in millimetres with vertex colours.
#pragma once

#include <filesystem>

#include "offline/mesh/mesh.h"
#include "runtime/geometry/rigid_transform.h"

namespace sextant {

/// Writes a mesh in mm in the frame that `file_from_mesh` leads to (metres). Colour of a vertex: its own,
/// times its part's, times the texture at its uv. Throws InputError(file) where it cannot be written.
void write_ply_mm(const std::filesystem::path& file, const Mesh& mesh, const RigidTransform& file_from_mesh);

}  // namespace sextant
