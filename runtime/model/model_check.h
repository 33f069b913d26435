// SPDX-License-Identifier: Apache-2.0
// What a model must fulfil before anything may use or store it: the ranges that the search, the refinement
// and the overlays rely on. Both sides of the model file ask here.
#pragma once

#include <cstddef>
#include <string>

#include "runtime/model/object_model.h"

namespace sextant {

inline constexpr std::size_t kMaxModelBins = 5000;
inline constexpr std::size_t kMaxPartsPerKind = 4096;  ///< visual parts of a bin; depth parts of a bin
inline constexpr std::size_t kMaxModelVertices = 1 << 20;
inline constexpr std::size_t kMaxModelTriangles = 1 << 21;
inline constexpr std::size_t kMaxMarks = 65536;
inline constexpr double kMaxObjectRadiusM = 10;

/// Throws InputError(where) with the first thing that is out of range: counts, kinds, boxes, non-finite or
/// absurd numbers, a rotation that is none, triangles of vertices that do not exist, unprintable names.
/// `advice` ends the message.
void check_model(const ObjectModel& model, const std::string& where, const std::string& advice);

/// Whether a text is UTF-8 without control characters, so that it can be printed and put into JSON.
bool is_printable_utf8(const std::string& text);

}  // namespace sextant
