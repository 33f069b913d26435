// SPDX-License-Identifier: Apache-2.0
// Canny's second half: of a gradient's ridges those that are strong, and those that touch them (J. Canny, A
// Computational Approach to Edge Detection, 1986; the same pixels as cv::Canny with L2 norms, its plain
// twin).
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "runtime/features/gradient.h"

namespace sextant {

/// Keeps its memory between images.
class Thinning {
 public:
  /// edges: CV_8UC1, 255 where the pixel's gradient is the longest across the edge and longer than `high`, or
  /// longer than `low` (0..high) and connected to such a pixel through others; else 0.
  void edges(const Gradient& gradient, int low, int high, cv::Mat& edges);

 private:
  std::vector<std::int32_t> norms_;  ///< three rows
  std::vector<std::uint8_t> marks_;  ///< with a border of one pixel: 0 none, 1 weak, 2 strong
  std::vector<std::uint8_t*> to_visit_;
};

}  // namespace sextant
