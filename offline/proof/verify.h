// SPDX-License-Identifier: Apache-2.0
// Re-establishes the claims of a proof, with plain scalar code on one thread: the tables are made and checked
// by their definition, every box is bounded anew, every detection scored anew. Of the search engine nothing
// is used.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "offline/proof/proof.h"

namespace sextant {

/// What became of one object's claim.
struct VerifiedObject {
  std::string name;
  SearchStatus status = SearchStatus::kAbsent;
  std::size_t detections = 0;
  std::uint64_t boxes = 0;
  std::string wrong;  ///< empty: the claim holds
};

/// The detector was made from the proof's models and options, `frame` is what frame_proof says it is about.
/// Throws InputError(where) where the frame, its table or the structure of the proof do not fit.
std::vector<VerifiedObject> verify_frame(Detector& detector, const Proof& proof,
                                         const FrameProof& frame_proof, const RgbdFrame& frame,
                                         const std::string& where);

}  // namespace sextant
