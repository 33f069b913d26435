// SPDX-License-Identifier: Apache-2.0
#include "offline/learn/select_parts.h"

#include <algorithm>

namespace sextant {

std::vector<PartCandidate> select_greedily(const std::vector<PartCandidate>& sorted, double d_min,
                                           std::size_t wanted) {
  std::vector<PartCandidate> chosen;
  const double least2 = d_min * d_min;
  for (const PartCandidate& candidate : sorted) {
    if (chosen.size() >= wanted) break;
    const bool crowded = std::any_of(chosen.begin(), chosen.end(), [&](const PartCandidate& other) {
      return other.kind == candidate.kind && (other.position - candidate.position).squaredNorm() <= least2;
    });
    if (!crowded) chosen.push_back(candidate);
  }
  return chosen;
}

namespace {

void sort_by_variance(std::vector<PartCandidate>& candidates, double max_variance) {
  std::erase_if(candidates, [&](const PartCandidate& c) { return !(c.variance <= max_variance); });
  std::sort(candidates.begin(), candidates.end(), [](const PartCandidate& a, const PartCandidate& b) {
    return a.variance != b.variance ? a.variance < b.variance : a.index < b.index;
  });
}

/// The largest whole spacing that yields `wanted` parts of sorted candidates, else 0.
int largest_spacing(const std::vector<PartCandidate>& sorted, std::size_t wanted) {
  int enough = 0;  // the largest spacing known to yield `wanted`
  int too_wide = kLargestSpacing + 1;
  while (too_wide - enough > 1) {
    const int middle = (enough + too_wide) / 2;
    (select_greedily(sorted, middle, wanted).size() >= wanted ? enough : too_wide) = middle;
  }
  return enough;
}

}  // namespace

ChosenParts select_parts(std::vector<PartCandidate> candidates, std::size_t wanted, double max_variance) {
  sort_by_variance(candidates, max_variance);
  const int spacing = largest_spacing(candidates, wanted);
  return {select_greedily(candidates, spacing, wanted), spacing};
}

}  // namespace sextant
