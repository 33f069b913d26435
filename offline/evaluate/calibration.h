// SPDX-License-Identifier: Apache-2.0
// Whether a stated confidence is what it claims: the reliability curve and the expected calibration error
// (Naeini et al., "Obtaining well calibrated probabilities using Bayesian binning", AAAI 2015).
#pragma once

#include <optional>
#include <vector>

#include "offline/evaluate/average_precision.h"

namespace sextant {

/// One tenth of the confidences.
struct CalibrationBin {
  int count = 0;
  double mean_confidence = 0;
  double share_right = 0;
};

struct Calibration {
  std::vector<CalibrationBin> bins;  ///< ten, for confidences 0..0.1, .. 0.9..1
  double expected_error = 0;         ///< mean |share right - confidence|, weighted by the bins' counts
  int sure = 0;                      ///< answers with a confidence above 0.95
  double share_sure_right = 0;       ///< of them
};

/// Nothing where there is no answer, or a score is no probability (outside of 0..1).
std::optional<Calibration> calibration(const std::vector<ScoredHit>& answers);

}  // namespace sextant
