// SPDX-License-Identifier: Apache-2.0
#include "offline/evaluate/calibration.h"

#include <algorithm>
#include <cmath>

namespace sextant {
namespace {

constexpr std::size_t kBins = 10;
constexpr double kSure = 0.95;

}  // namespace

std::optional<Calibration> calibration(const std::vector<ScoredHit>& answers) {
  if (answers.empty()) return std::nullopt;
  Calibration result;
  result.bins.resize(kBins);
  int sure_right = 0;
  for (const ScoredHit& answer : answers) {
    if (!(answer.score >= 0 && answer.score <= 1)) return std::nullopt;
    const auto bin = std::min(kBins - 1, static_cast<std::size_t>(answer.score * kBins));
    ++result.bins[bin].count;
    result.bins[bin].mean_confidence += answer.score;
    result.bins[bin].share_right += answer.hit ? 1 : 0;
    if (answer.score > kSure) {
      ++result.sure;
      sure_right += answer.hit ? 1 : 0;
    }
  }
  for (CalibrationBin& bin : result.bins) {
    if (bin.count == 0) continue;
    bin.mean_confidence /= bin.count;
    bin.share_right /= bin.count;
    result.expected_error += std::abs(bin.share_right - bin.mean_confidence) * bin.count;
  }
  result.expected_error /= static_cast<double>(answers.size());
  if (result.sure > 0) result.share_sure_right = static_cast<double>(sure_right) / result.sure;
  return result;
}

}  // namespace sextant
