// SPDX-License-Identifier: Apache-2.0
// From a mesh file to a flat Mesh through assimp. Runs inside the isolated child (isolation.h): assimp is
// not trusted with hostile files. Use read_mesh (mesh_reader.h) instead of this.
#pragma once

#include <filesystem>
#include <string>

#include "offline/mesh/mesh.h"

namespace sextant {

/// Most triangles that a mesh may have.
inline constexpr std::size_t kMaxTriangles = 2'000'000;

/// Reads PLY, OBJ (+ MTL), STL, glTF 2 / GLB or Collada with all nodes' transforms applied, in the file's
/// own frame: no axis is turned (Collada's up_axis is ignored). Units are the file's own, except that
/// Collada's declared unit is applied (its result is in metres, as glTF is by definition).
/// Vertices without a usable normal have the zero vector. Throws InputError.
Mesh import_mesh(const std::filesystem::path& file);

/// The format by the file's name: "ply", "obj", "stl", "gltf", "glb", "dae"; empty for any other extension.
std::string mesh_format(const std::filesystem::path& file);

}  // namespace sextant
