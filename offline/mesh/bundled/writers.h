// SPDX-License-Identifier: Apache-2.0
// Writes meshes in the formats that the bundled ones use. Plain and small: our reader is assimp.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "offline/mesh/mesh.h"

namespace sextant {

using FileBytes = std::vector<std::byte>;

/// Binary PLY with positions and vertex colours.
FileBytes ply_bytes(const Mesh& mesh);
/// Binary STL with facet normals; one solid, no colours.
FileBytes stl_bytes(const Mesh& mesh, const std::string& title);
/// OBJ text with positions, texture coordinates and normals; parts use the material "print".
FileBytes obj_bytes(const Mesh& mesh, const std::string& material_file);
/// MTL text: the material "print" with one texture.
FileBytes mtl_bytes(const std::string& texture_file);
/// GLB (glTF 2.0, y up as the standard wants: z becomes y) with normals, base colours and textures embedded
/// as PNG. `metres_per_unit` scales the positions.
FileBytes glb_bytes(const Mesh& mesh, double metres_per_unit);
/// PNG of a CV_8UC3 RGB picture.
FileBytes png_bytes(const cv::Mat& image);

}  // namespace sextant
