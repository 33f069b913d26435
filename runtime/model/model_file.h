// SPDX-License-Identifier: Apache-2.0
// The model file: FlatBuffers (idl/object_model.fbs), mapped and verified before anything is believed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "runtime/model/object_model.h"

namespace sextant {

/// Format version that this program writes, and the only one that it reads.
inline constexpr std::uint32_t kModelFormatVersion = 1;

/// Bytes of a model file. Coefficients are rounded to 16 bit: what is read back differs from `model` by less
/// than half a step (see quantisation in idl/object_model.fbs), far below the sensor's noise.
std::vector<std::byte> encode_model(const ObjectModel& model);

/// Decodes and checks bytes of a model file: identifier, version, checksum, structure, every value's range.
/// Throws InputError(where) with the reason.
ObjectModel decode_model(std::span<const std::byte> bytes, const std::string& where);

/// Maps, verifies and decodes a file. Throws InputError.
ObjectModel read_model(const std::filesystem::path& file);

/// Writes atomically (temporary file beside it, then rename). Throws InputError where it cannot.
void write_model(const ObjectModel& model, const std::filesystem::path& file);

/// XXH3-64 checksum of the model's content, as stored in the file: the model's identity.
std::uint64_t model_hash(std::span<const std::byte> bytes);

}  // namespace sextant
