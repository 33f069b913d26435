// SPDX-License-Identifier: Apache-2.0
#include "offline/calibrate/reliability.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace sextant {

Reliability reliability(const std::vector<Answer>& answers) {
  constexpr int kBins = 10;
  Reliability r;
  r.bins.resize(kBins);
  for (const Answer& a : answers) {
    const int k = std::clamp(static_cast<int>(a.confidence * kBins), 0, kBins - 1);
    ReliabilityBin& bin = r.bins[static_cast<std::size_t>(k)];
    ++bin.answers;
    bin.mean_confidence += a.confidence;
    bin.share_right += a.right ? 1 : 0;
    if (a.confidence > 0.95) {
      ++r.sure;
      r.sure_and_right += a.right ? 1 : 0;
    }
  }
  for (ReliabilityBin& bin : r.bins) {
    if (bin.answers == 0) continue;
    bin.mean_confidence /= bin.answers;
    bin.share_right /= bin.answers;
    r.expected_error +=
        std::abs(bin.mean_confidence - bin.share_right) * bin.answers / static_cast<double>(answers.size());
  }
  return r;
}

std::string format_reliability(const Reliability& r) {
  std::string text = "confidence   answers  mean  right\n";
  for (std::size_t i = 0; i < r.bins.size(); ++i) {
    const ReliabilityBin& b = r.bins[i];
    if (b.answers == 0) continue;
    text += fmt::format("{:.1f} - {:.1f}    {:7}  {:.2f}  {:.2f}\n", 0.1 * static_cast<double>(i),
                        0.1 * static_cast<double>(i + 1), b.answers, b.mean_confidence, b.share_right);
  }
  text += fmt::format("expected calibration error {:.3f}; of {} answers above 0.95, {} right\n",
                      r.expected_error, r.sure, r.sure_and_right);
  return text;
}

}  // namespace sextant
