// SPDX-License-Identifier: Apache-2.0
// EVAL (Davies 2015, Procs. 11-13): the score of one lattice pose. This function defines the score: single
// precision, fixed order of operations, no contraction (-ffp-contract=off), parts summed in double.
#pragma once

#include "runtime/search/lattice.h"
#include "runtime/search/scored_bin.h"
#include "runtime/tables/frame_tables.h"

namespace sextant {

double evaluate(const ScoredBin& bin, const FrameTables& tables, const LatticePose& pose);

}  // namespace sextant
