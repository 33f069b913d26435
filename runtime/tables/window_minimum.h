// SPDX-License-Identifier: Apache-2.0
// The vector kernels of LaneTables, chosen for the CPU at run time (Highway).
#pragma once

#include <cstddef>
#include <cstdint>

namespace sextant {

/// out[i] = smallest of a[i], b[i], c[i], d[i] for i < count.
void fold_smallest_u8(const std::uint8_t* a, const std::uint8_t* b, const std::uint8_t* c,
                      const std::uint8_t* d, std::uint8_t* out, std::size_t count);
/// The same for depths whose bit 0 is a flag: smallest value, flag set where any of the four has it.
void fold_nearest_u16(const std::uint16_t* a, const std::uint16_t* b, const std::uint16_t* c,
                      const std::uint16_t* d, std::uint16_t* out, std::size_t count);
/// out[i] = largest of the four.
void fold_largest_u16(const std::uint16_t* a, const std::uint16_t* b, const std::uint16_t* c,
                      const std::uint16_t* d, std::uint16_t* out, std::size_t count);
/// out[i] = smallest of a[2i], a[2i + 1], b[2i], b[2i + 1] for i < count: half the resolution.
void halve_smallest_u8(const std::uint8_t* a, const std::uint8_t* b, std::uint8_t* out, std::size_t count);
void halve_nearest_u16(const std::uint16_t* a, const std::uint16_t* b, std::uint16_t* out, std::size_t count);
void halve_largest_u16(const std::uint16_t* a, const std::uint16_t* b, std::uint16_t* out, std::size_t count);
/// out[p][i] = row[i * phases + p] for i < count; phases: 1, 2 or 4.
void split_phases_u8(const std::uint8_t* row, std::size_t phases, std::size_t count,
                     std::uint8_t* const* out);
void split_phases_u16(const std::uint16_t* row, std::size_t phases, std::size_t count,
                      std::uint16_t* const* out);
/// out[i] = depth[i] rounded down to even, missing (65535) as it is.
void flag_missing_u16(const std::uint16_t* depth, std::uint16_t* out, std::size_t count);
/// out[i] = floor(scale * sqrt(distance2[i])), 255 where distance2 is 65535 (none) or the code would be
/// larger.
void distance_codes(const std::uint16_t* distance2, int scale, std::uint8_t* out, std::size_t count);

}  // namespace sextant
