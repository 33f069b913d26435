// SPDX-License-Identifier: Apache-2.0
// How a region is divided: only the dimension with the largest effect on where the parts fall and what depth
// they expect, in units of their receptive fields. (The thesis halves all six at once, Davies 2015
// sec. 5.3.1: 64 children that are nearly as loose as their parent.)
#pragma once

#include <utility>

#include "runtime/search/lattice.h"
#include "runtime/search/scored_bin.h"

namespace sextant {

/// The two halves of a region that is not a single pose. focal: pixels.
std::pair<Region, Region> halves(const ScoredBin& bin, double bounding_radius_m, double focal,
                                 const Region& region);

}  // namespace sextant
