// SPDX-License-Identifier: Apache-2.0
#include "hal/playback/depth_image.h"

#include <fmt/format.h>

#include "runtime/base/error.h"

namespace sextant {

cv::Mat depth_in_metres(const cv::Mat& raw, double scale_mm) {
  cv::Mat metres;
  raw.convertTo(metres, CV_32FC1, scale_mm / 1000.0);
  return metres;
}

void require_same_size(const cv::Mat& colour, const std::filesystem::path& colour_file, const cv::Mat& depth,
                       const std::filesystem::path& depth_file) {
  if (colour.size() == depth.size()) return;
  throw InputError(depth_file.string(),
                   fmt::format("has {} x {} pixels, but {} has {} x {}", depth.cols, depth.rows,
                               colour_file.string(), colour.cols, colour.rows),
                   "register the depth to the colour image first");
}

}  // namespace sextant
