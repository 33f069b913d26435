// SPDX-License-Identifier: Apache-2.0
// A Mesh as bytes, for the way from the isolated child to us. Same machine, same program: native layout.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "offline/mesh/mesh.h"

namespace sextant {

/// All of the mesh, textures included.
std::vector<std::byte> bytes_from_mesh(const Mesh& mesh);

/// The inverse. Believes nothing: empty where lengths, indices or texture numbers do not fit together.
/// Values (NaN, zero area) are not looked at.
std::optional<Mesh> mesh_from_bytes(std::span<const std::byte> bytes);

}  // namespace sextant
