// SPDX-License-Identifier: Apache-2.0
// The thesis's search, faithfully (Davies 2015, Procs. 20, 29, 30): all six dimensions halved at once,
// minimum resolution regions evaluated exhaustively. Their best pose goes back to the queue with its exact
// score, as the text says and Proc. 29 as printed forgets. It need not finish on whole images: it is the
// baseline.
#pragma once

#include "runtime/search/branch_and_bound.h"

namespace sextant {

/// Same contract as branch_and_bound, but only the single best pose (max_detections is 1).
SearchOutcome thesis_search(const SearchProblem& problem, const SearchOptions& options);

}  // namespace sextant
