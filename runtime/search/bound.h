// SPDX-License-Identifier: Apache-2.0
// Upper bound of `evaluate` over a region, from window minima: one look-up per part, exact where the region
// is a single pose. Sound without slack: see part_arithmetic.h.
#pragma once

#include "runtime/search/lattice.h"
#include "runtime/search/scored_bin.h"
#include "runtime/tables/frame_tables.h"

namespace sextant {

/// bound(region) >= evaluate(pose) for every pose of the region. Stops early and returns a value below
/// `floor` as soon as the bound is known to be below `floor`.
double window_bound(const ScoredBin& bin, const FrameTables& tables, const Region& region, double floor);

}  // namespace sextant
