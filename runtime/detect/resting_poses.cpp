// SPDX-License-Identifier: Apache-2.0
#include "runtime/detect/resting_poses.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace sextant {

std::vector<RestingChoice> one_per_place(const std::vector<RestingAnswer>& answers,
                                         const std::vector<RestingBound>& bounds, int most) {
  std::vector<std::size_t> order(answers.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return answers[a].score > answers[b].score; });
  std::vector<RestingChoice> kept;
  std::vector<std::size_t> dropped;
  for (const std::size_t i : order) {
    const bool hidden = std::any_of(kept.begin(), kept.end(), [&](const RestingChoice& k) {
      return intersection_over_union(answers[k.answer].box, answers[i].box) > kSuppressionIou;
    });
    if (hidden || static_cast<int>(kept.size()) >= most) {
      dropped.push_back(i);
    } else {
      kept.push_back({i});
    }
  }
  // A dropped answer may have suppressed others of its model, which nothing that is reported suppresses: they
  // score no higher than it did.
  double upper_bound = -std::numeric_limits<double>::infinity();
  for (const RestingBound& b : bounds) upper_bound = std::max(upper_bound, b.upper_bound);
  for (const std::size_t i : dropped) upper_bound = std::max(upper_bound, answers[i].score);
  for (RestingChoice& k : kept) {
    k.upper_bound = upper_bound;
    k.rival = -std::numeric_limits<double>::infinity();
    const auto offer = [&](double score, bool exact) {
      if (score < k.rival || (score == k.rival && !exact)) return;
      k.rival = score;
      k.rival_exact = exact;
    };
    for (const RestingBound& b : bounds) {
      if (b.model != answers[k.answer].model) offer(b.upper_bound, false);
    }
    for (const std::size_t i : dropped) {
      if (answers[i].model != answers[k.answer].model) offer(answers[i].score, true);
    }
  }
  return kept;
}

}  // namespace sextant
