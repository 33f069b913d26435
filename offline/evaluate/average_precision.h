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

/// A point of the precision-recall curve: what holds for all detections of at least this score.
struct PrecisionRecall {
  double score = 0, precision = 0, recall = 0;
};

/// One point per score that occurs, falling. Empty without positives.
std::vector<PrecisionRecall> precision_recall_curve(std::vector<ScoredHit> detections, int positives);

}  // namespace sextant
