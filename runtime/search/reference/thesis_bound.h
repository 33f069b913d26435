// SPDX-License-Identifier: Apache-2.0
// The thesis's bounds, faithfully (Davies 2015, Procs. 16-19): a part scores its best where any feature lies
// within reach of its projected rectangle, its worst where none does.
#pragma once

#include "runtime/search/lattice.h"
#include "runtime/search/reference/thesis_tables.h"
#include "runtime/search/scored_bin.h"

namespace sextant {

/// BOUND (Proc. 19): >= evaluate(pose) for every pose of the region.
double thesis_bound(const ScoredBin& bin, const ThesisTables& tables, const Region& region);

}  // namespace sextant
