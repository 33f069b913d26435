// SPDX-License-Identifier: Apache-2.0
// A proof as a file: one JSON object with a checksum over everything else. Numbers are written so that they
// are read back bit for bit.
#pragma once

#include <filesystem>
#include <string>

#include "offline/proof/proof.h"

namespace sextant {

inline constexpr int kProofVersion = 1;
/// Larger files are refused.
inline constexpr std::uint64_t kMostProofBytes = std::uint64_t{1} << 30U;

std::string format_proof(const Proof& proof);
/// Throws InputError(where) for text that is no proof, is damaged, or has values that cannot be.
Proof parse_proof(const std::string& text, const std::string& where);

void write_proof(const std::filesystem::path& file, const Proof& proof);
Proof read_proof(const std::filesystem::path& file);

}  // namespace sextant
