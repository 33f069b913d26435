// SPDX-License-Identifier: Apache-2.0
// A learnt bin as bytes, for the way between processes of one job (worker processes, MPI ranks). Exact:
// floats travel as they are.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "runtime/model/object_model.h"

namespace sextant {

std::vector<std::byte> encode_bin(const ViewpointBin& bin);
/// Throws std::runtime_error for bytes that encode_bin did not write.
ViewpointBin decode_bin(std::span<const std::byte> bytes);

}  // namespace sextant
