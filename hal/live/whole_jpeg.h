// SPDX-License-Identifier: Apache-2.0
// Tells a JPEG that was cut on its way from a whole one by its first and last marker, without decoding it.
#pragma once

#include <cstddef>
#include <span>

namespace sextant {

/// True where the bytes begin with a JPEG's start marker and end with its end marker, zero bytes after it
/// aside (drivers pad). A whole frame may still be damaged inside: decoding tells.
inline bool is_whole_jpeg(std::span<const std::byte> bytes) {
  std::size_t size = bytes.size();
  while (size > 0 && bytes[size - 1] == std::byte{0}) --size;
  return size >= 4 && bytes[0] == std::byte{0xff} && bytes[1] == std::byte{0xd8} &&
         bytes[size - 2] == std::byte{0xff} && bytes[size - 1] == std::byte{0xd9};
}

}  // namespace sextant
