// SPDX-License-Identifier: Apache-2.0
// The gradient of a colour image: smoothed by [1 2 1] x [1 2 1] / 16, Sobel, and of the three channels the
// one whose gradient is longest. A third of the time of features was here; it is one sweep over the rows.
#pragma once

#include <opencv2/core.hpp>

namespace sextant {

struct Gradient {
  cv::Mat dx;  ///< CV_16SC1, -1020..1020
  cv::Mat dy;  ///< CV_16SC1, the same
};

/// colour: CV_8UC3, not empty. Borders are replicated. `out` keeps its memory where the size allows.
void strongest_gradient(const cv::Mat& colour, Gradient& out);
/// The same from OpenCV's filters, channel by channel: the plain twin.
Gradient strongest_gradient_plain(const cv::Mat& colour);

}  // namespace sextant
