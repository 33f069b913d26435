// SPDX-License-Identifier: Apache-2.0
// Which BOP object a file stands for where nobody says so.
#pragma once

#include <filesystem>
#include <optional>

namespace sextant {

/// The first number in the file's name, as in obj_000005.ply; nothing where there is none (or an absurd one).
std::optional<int> object_id_in_name(const std::filesystem::path& file);

}  // namespace sextant
