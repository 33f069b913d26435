// SPDX-License-Identifier: Apache-2.0
// Average precision: the area under the precision-recall curve when the score's threshold is lowered.
#pragma once

#include <vector>

namespace sextant {

struct ScoredHit {
  double score = 0;
  bool hit = false;  ///< a true positive
};

/// Area under the interpolated precision (each recall gets the best precision at this or a higher recall),
/// 0..1. positives: number of true objects. Equal scores are taken hits last, so that a tie never helps.
double average_precision(std::vector<ScoredHit> detections, int positives);

}  // namespace sextant
