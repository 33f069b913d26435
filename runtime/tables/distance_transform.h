// SPDX-License-Identifier: Apache-2.0
// Squared Euclidean distance transform, clipped: exact within the clip radius (Davies 2015, eq. 4.9).
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

namespace sextant {

/// out[(y) * out_stride + x] = squared distance in pixels to the nearest pixel of `edges` that has bit
/// `kind`, or 65535 where none lies within clip_radius (1..200). edges: CV_8UC1.
void clipped_distance2(const cv::Mat& edges, int kind, int clip_radius, std::uint16_t* out, int out_stride);

}  // namespace sextant
