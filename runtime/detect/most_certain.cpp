// SPDX-License-Identifier: Apache-2.0
#include "runtime/detect/most_certain.h"

#include <algorithm>
#include <map>

namespace sextant {
namespace {

/// A pose of this log score is not reported after all.
void speak_of(double dropped, PoseEstimate& e) {
  e.upper_bound = std::max(e.upper_bound, dropped);
  e.gap = std::max(0.0, e.upper_bound - e.log_score);
  if (e.gap > 0) e.status = SearchStatus::kBounded;
  const double margin = std::max(0.0, e.log_score - dropped);
  if (margin < e.runner_up_margin) {
    e.runner_up_margin = margin;
    e.runner_up_exact = margin > 0;
  }
}

}  // namespace

std::vector<std::size_t> keep_most_certain(std::vector<PoseEstimate>& estimates,
                                           const std::vector<double>& found,
                                           const std::vector<std::size_t>& object_of, int most) {
  std::map<std::size_t, std::vector<std::size_t>> by_object;
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    by_object[object_of.at(estimates[i].model_index)].push_back(i);
  }
  std::vector<std::size_t> kept;
  for (auto& [object, of_object] : by_object) {
    std::stable_sort(of_object.begin(), of_object.end(),
                     [&](std::size_t a, std::size_t b) { return estimates[a].score > estimates[b].score; });
    const std::size_t count = std::min(of_object.size(), static_cast<std::size_t>(most));
    for (std::size_t k = 0; k < count; ++k) {
      for (std::size_t d = count; d < of_object.size(); ++d) {
        const std::size_t dropped = of_object[d];
        speak_of(std::max(found.at(dropped), estimates[dropped].log_score), estimates[of_object[k]]);
      }
      kept.push_back(of_object[k]);
    }
  }
  std::sort(kept.begin(), kept.end());
  return kept;
}

}  // namespace sextant
