// SPDX-License-Identifier: Apache-2.0
#include "runtime/search/part_likelihood.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sextant {

double PartLikelihood::at(double difference2, double spread) const {
  return std::max(gain - difference2 / (2 * spread), out);
}

PartLikelihood likelihood_of(const PartStatistics& seen, int dimensions) {
  constexpr double kGate2 = kFoundSigmas * kFoundSigmas;
  const double peak = dimensions == 2 ? kGate2 / 2 : 2 * kFoundSigmas / std::sqrt(2 * std::numbers::pi);
  const double found = seen.found;
  const double background = std::min<double>(seen.background, found);
  return {std::log(peak * found / background), std::log((1 - found) / (1 - background))};
}

}  // namespace sextant
