// SPDX-License-Identifier: Apache-2.0
// The bytes of a file that is not trusted: only regular files (a FIFO or a device would never end), and
// never more than a limit that the caller names.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <vector>

namespace sextant {

/// Largest image file that is read.
inline constexpr std::size_t kMaxImageFileBytes = std::size_t{256} << 20;

/// All bytes of a file. Throws InputError(file) where it is missing, no regular file, unreadable, or larger
/// than max_bytes.
std::vector<std::byte> read_file_bytes(const std::filesystem::path& file, std::size_t max_bytes);

/// Replaces a file's content: written beside it and renamed, so a reader never sees half of it.
/// Throws InputError(file) where the folder is missing or full or not writable.
void write_file_bytes(const std::filesystem::path& file, std::span<const std::byte> bytes);

}  // namespace sextant
