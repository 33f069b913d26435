// SPDX-License-Identifier: Apache-2.0
// Whether confidences mean what they say: of the answers given with confidence p, a share p should be right
// (Guo et al. 2017, "On calibration of modern neural networks").
#pragma once

#include <string>
#include <vector>

namespace sextant {

/// An answer.
struct Answer {
  double confidence = 0;
  bool right = false;
};

/// The answers whose confidence falls into one tenth.
struct ReliabilityBin {
  int answers = 0;
  double mean_confidence = 0;
  double share_right = 0;
};

struct Reliability {
  std::vector<ReliabilityBin> bins;  ///< ten, of equal width
  double expected_error = 0;         ///< mean of |mean confidence - share right|, weighted by answers
  int sure = 0;                      ///< answers of more than 0.95
  int sure_and_right = 0;
};

Reliability reliability(const std::vector<Answer>& answers);

/// A table of a few lines, with line ends.
std::string format_reliability(const Reliability& r);

}  // namespace sextant
