// SPDX-License-Identifier: Apache-2.0
// What BOP playback and single frames share: raw 16-bit depth to metres, and the check that the two images
// match.
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>

namespace sextant {

/// CV_16UC1 depth values times scale_mm, as CV_32FC1 metres; 0 stays 0 (missing).
cv::Mat depth_in_metres(const cv::Mat& raw, double scale_mm);

/// Throws InputError(depth_file) unless both images have the same size.
void require_same_size(const cv::Mat& colour, const std::filesystem::path& colour_file, const cv::Mat& depth,
                       const std::filesystem::path& depth_file);

}  // namespace sextant
