// SPDX-License-Identifier: Apache-2.0
#include "offline/evaluate/average_precision.h"

#include <algorithm>

namespace sextant {

double average_precision(std::vector<ScoredHit> detections, int positives) {
  if (positives <= 0) return 0;
  std::sort(detections.begin(), detections.end(), [](const ScoredHit& a, const ScoredHit& b) {
    return a.score != b.score ? a.score > b.score : !a.hit && b.hit;
  });
  // Precision just after each hit; between hits recall does not change.
  std::vector<double> precision;
  int hits = 0;
  for (std::size_t i = 0; i < detections.size(); ++i) {
    if (!detections[i].hit) continue;
    ++hits;
    precision.push_back(static_cast<double>(hits) / static_cast<double>(i + 1));
  }
  double area = 0;
  double best = 0;
  for (auto it = precision.rbegin(); it != precision.rend(); ++it) {
    best = std::max(best, *it);
    area += best / positives;
  }
  return area;
}

std::vector<PrecisionRecall> precision_recall_curve(std::vector<ScoredHit> detections, int positives) {
  std::vector<PrecisionRecall> curve;
  if (positives <= 0) return curve;
  std::sort(detections.begin(), detections.end(),
            [](const ScoredHit& a, const ScoredHit& b) { return a.score > b.score; });
  int hits = 0;
  for (std::size_t i = 0; i < detections.size(); ++i) {
    hits += detections[i].hit ? 1 : 0;
    if (i + 1 < detections.size() && detections[i + 1].score == detections[i].score) continue;
    curve.push_back({detections[i].score, static_cast<double>(hits) / static_cast<double>(i + 1),
                     static_cast<double>(hits) / positives});
  }
  return curve;
}

}  // namespace sextant
