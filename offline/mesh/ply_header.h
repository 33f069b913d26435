// SPDX-License-Identifier: Apache-2.0
// The header of a PLY file, read strictly before the importer sees the file: assimp's PLY importer spins
// for ever where a header does not end, and allocates what the header promises.
#pragma once

#include <cstdint>
#include <filesystem>

namespace sextant {

/// What a PLY file promises.
struct PlyHeader {
  std::uint64_t vertices = 0;
  std::uint64_t faces = 0;
};

/// Reads and checks the header: format, elements with their properties, end_header; and that the file is long
/// enough for as many elements. Throws InputError.
PlyHeader read_ply_header(const std::filesystem::path& file);

}  // namespace sextant
