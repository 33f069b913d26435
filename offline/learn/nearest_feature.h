// SPDX-License-Identifier: Apache-2.0
// Distance transform with arg-min indices (Davies 2015, eq. 4.9; Felzenszwalb & Huttenlocher 2012): for each
// pixel, where the nearest feature of one kind is.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace sextant {

/// Pixel of the nearest feature; column -1 where the image has none.
struct NearestFeature {
  std::int16_t column = -1;
  std::int16_t row = -1;
};

/// Row-major, one entry per pixel of `edges` (CV_8UC1, bit `kind` marks features). Exact. Of equally near
/// features any one, but always the same. rows: where not empty, only rows marked in it (one per row of
/// `edges`) are filled.
std::vector<NearestFeature> nearest_features(const cv::Mat& edges, int kind,
                                             const std::vector<bool>& rows = {});

}  // namespace sextant
