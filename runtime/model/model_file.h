// SPDX-License-Identifier: Apache-2.0
// The model file: FlatBuffers (idl/model/object_model.fbs), mapped and verified before anything is believed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "runtime/model/object_model.h"

namespace sextant {

/// Format version that this program writes, and the only one that it reads.
inline constexpr std::uint32_t kModelFormatVersion = 3;

/// Larger files are not models.
inline constexpr std::size_t kMaxModelFileBytes = std::size_t{64} << 20;

/// Bytes of a model file. Coefficients are rounded to 16 bit: what is read back differs from `model` by less
/// than half a step (see idl/model/object_model.fbs), far below the sensor's noise: 0.05 px of a camera of
/// 525 px at 0.5 m, 0.1 mm, 0.1 % of a variance. Encoding what was decoded gives the same bytes. Throws
/// InputError for a model that check_model refuses, or with a coefficient that 16 bits cannot hold so
/// exactly.
std::vector<std::byte> encode_model(const ObjectModel& model);

/// Decodes and checks bytes of a model file: identifier, version, checksum, structure, every value's range.
/// Throws InputError(where) with the reason.
ObjectModel decode_model(std::span<const std::byte> bytes, const std::string& where);

/// Maps, verifies and decodes a file. Throws InputError. Replace a model file by renaming a new one over it,
/// as write_model does: a program that writes into a file while another one maps it can make that one fail.
ObjectModel read_model(const std::filesystem::path& file);

/// The same, and what the file itself is.
struct ModelFileContent {
  ObjectModel model;
  std::uint64_t hash = 0;  ///< see model_hash
  std::size_t bytes = 0;   ///< of the file
};
ModelFileContent read_model_file(const std::filesystem::path& file);

/// Writes atomically (temporary file beside it, then rename). Throws InputError where it cannot.
void write_model(const ObjectModel& model, const std::filesystem::path& file);

/// XXH3-64 checksum of the model's content, as stored in the file: the model's identity. Throws InputError
/// for bytes that are shorter than a header or not a model.
std::uint64_t model_hash(std::span<const std::byte> bytes);

}  // namespace sextant
