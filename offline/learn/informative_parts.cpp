// SPDX-License-Identifier: Apache-2.0
#include "offline/learn/informative_parts.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "runtime/search/part_likelihood.h"

namespace sextant {
namespace {

double evidence_of(const VisualPart& part) {
  const PartLikelihood likelihood = likelihood_of(part.seen, 2);
  return likelihood.gain - likelihood.out;
}

double weighted_evidence(const std::vector<VisualPart>& parts) {
  return std::accumulate(parts.begin(), parts.end(), 0.0, [](double sum, const VisualPart& part) {
    return sum + static_cast<double>(part.seen.weight) * evidence_of(part);
  });
}

}  // namespace

double information_of(const VisualPart& part) {
  const double spread = part.seen.spread > 0 ? part.seen.spread : part.variance;
  return evidence_of(part) / std::max(spread, 1e-12);
}

void keep_most_informative(std::vector<VisualPart>& parts, std::size_t most) {
  if (parts.size() <= most) return;
  std::vector<std::size_t> order(parts.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return information_of(parts[a]) > information_of(parts[b]);
  });
  order.resize(most);
  std::sort(order.begin(), order.end());
  std::vector<VisualPart> kept;
  kept.reserve(most);
  for (const std::size_t i : order) kept.push_back(parts[i]);
  const double before = weighted_evidence(parts);
  const double after = weighted_evidence(kept);
  if (after > 0) {
    for (VisualPart& part : kept) part.seen.weight *= static_cast<float>(before / after);
  }
  parts = std::move(kept);
}

}  // namespace sextant
