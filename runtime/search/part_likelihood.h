// SPDX-License-Identifier: Apache-2.0
// What one observation of one part says (Davies 2015, sec. 3.4, normalised): the log-likelihood ratio of "the
// object is here" against "anything else is", from how often and how far off the part's feature was found in
// synthesised scenes. Scoring and the choice of parts both ask here.
#pragma once

#include "runtime/model/object_model.h"

namespace sextant {

/// A parabola in the difference, from `gain` at a perfect fit down to `out`, which an absent feature says:
/// max(gain - difference^2 / (2 spread), out).
struct PartLikelihood {
  double gain = 0;
  double out = 0;

  double at(double difference2, double spread) const;
};

/// dimensions: 2 for places of edges, 1 for depths. Within kFoundSigmas, found features are normally
/// distributed on the object and uniformly by chance.
PartLikelihood likelihood_of(const PartStatistics& seen, int dimensions);

}  // namespace sextant
