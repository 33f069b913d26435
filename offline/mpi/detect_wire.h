// SPDX-License-Identifier: Apache-2.0
// What the ranks of a search must agree on, as bytes: the options of detection and what one frame is asked
// for. What only the coordinator does (refinement, confidence, threads) stays with it.
#pragma once

#include "offline/mpi/search_wire.h"
#include "runtime/detect/detector.h"

namespace sextant {

void append_options(Bytes& bytes, const DetectOptions& options);
DetectOptions take_options(ByteReader& reader);

/// call: asked about each of the models.
void append_call(Bytes& bytes, const DetectCall& call, const std::vector<ObjectModel>& models);
DetectCall take_call(ByteReader& reader, const std::vector<ObjectModel>& models);

}  // namespace sextant
