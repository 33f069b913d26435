// SPDX-License-Identifier: Apache-2.0
// One object that may lie in several ways: a model for each resting pose, of the same mesh and with the same
// object id. They are searched as objects of their own; what is reported is one answer for each place
// (non-maximum suppression over all of them, Davies 2015, Proc. 34), with a certificate that holds for all of
// them together.
#pragma once

#include <cstddef>
#include <vector>

#include "runtime/search/suppression.h"

namespace sextant {

/// What one model found.
struct RestingAnswer {
  std::size_t model = 0;
  double score = 0;
  Box2 box;
};

/// What is known of one model's other poses.
struct RestingBound {
  std::size_t model = 0;
  double upper_bound = 0;  ///< of every pose that it did not find
};

struct RestingChoice {
  std::size_t answer = 0;  ///< index into the answers
  /// Of every pose, in any resting pose, that is not reported and not suppressed by what is.
  double upper_bound = 0;
  double rival = 0;          ///< no unreported pose of another model scores higher
  bool rival_exact = false;  ///< one scores just that
};

/// The answers to report for one object, best first (among equals: the earlier), at most `most`. bounds: one
/// for each of its models.
std::vector<RestingChoice> one_per_place(const std::vector<RestingAnswer>& answers,
                                         const std::vector<RestingBound>& bounds, int most);

}  // namespace sextant
