// SPDX-License-Identifier: Apache-2.0
// Choosing parts (Davies 2015, Procs. 7-8): low variance first, spread by a minimum distance that is as large
// as the wanted number of parts allows. Ours: distances are between *predicted positions at the bin's
// centre*, per kind, because many enumeration pixels share one nearest feature.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace sextant {

/// A part that could be chosen.
struct PartCandidate {
  double variance = 0;
  Eigen::Vector2d position{0, 0};  ///< predicted at the bin's centre, in units of d_min
  int kind = 0;                    ///< only parts of one kind keep their distance
  std::size_t index = 0;           ///< the caller's name for it; breaks ties of variance
};

inline constexpr int kLargestSpacing = 500;

/// Procs. 7: greedy choice of at most `wanted` candidates (sorted by variance) farther than d_min apart.
std::vector<PartCandidate> select_greedily(const std::vector<PartCandidate>& sorted, double d_min,
                                           std::size_t wanted);

/// Proc. 8: drops candidates above max_variance, sorts, and finds the largest whole d_min in 0..500 that
/// still yields `wanted` parts; with fewer candidates than wanted, all that d_min = 0 yields.
struct ChosenParts {
  std::vector<PartCandidate> parts;
  int spacing = 0;  ///< the d_min that was used
};
ChosenParts select_parts(std::vector<PartCandidate> candidates, std::size_t wanted, double max_variance);

}  // namespace sextant
