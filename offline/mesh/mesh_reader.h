// SPDX-License-Identifier: Apache-2.0
// The door for meshes: a file of any supported format becomes a checked Mesh in metres, or one clear error.
#pragma once

#include <cstdint>
#include <filesystem>

#include "offline/mesh/isolation.h"
#include "offline/mesh/mesh.h"

namespace sextant {

/// Reads PLY, OBJ (+ MTL, PNG and JPEG textures beside or below it), STL, glTF 2, GLB or DAE in a child
/// process with limits (isolation.h). The result is in the mesh's own frame: nodes' transforms are applied,
/// no axis is turned; in metres: file units * metres_per_unit (glTF and DAE are in metres already: leave 1).
/// Only vertices that a triangle uses are kept; missing normals are computed (normals.h). Deterministic.
/// Throws InputError for a file that is missing, not a mesh, damaged, empty, not finite, without area,
/// of more than 2,000,000 triangles, or that refers to files outside of its folder.
Mesh read_mesh(const std::filesystem::path& file, double metres_per_unit = 1.0,
               const IsolationLimits& limits = IsolationLimits{});

/// XXH3-64 of the file's bytes. Throws InputError.
std::uint64_t mesh_file_hash(const std::filesystem::path& file);

}  // namespace sextant
