// SPDX-License-Identifier: Apache-2.0
// What a real colour camera makes of a perfect picture: exposure, white balance, vignetting, blur and noise.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

namespace sextant {

/// How bad the camera is. Gains are drawn per image.
struct ColourSensor {
  double exposure = 0.2;        ///< brightness is multiplied by 1 +- this (uniform)
  double white_balance = 0.06;  ///< each channel by 1 +- this
  double vignetting = 0.12;     ///< share of light lost in the corners, at most
  double blur_px_min = 0.4;     ///< sigma of the blur
  double blur_px_max = 0.9;
  double noise_min = 1.2;  ///< rms of the luminance noise, grey levels of 255
  double noise_max = 3.5;
};

/// CV_8UC3 RGB in and out. Pure: the same seed gives the same image.
cv::Mat apply_colour_sensor(const cv::Mat& colour, const ColourSensor& sensor, std::uint64_t seed);

}  // namespace sextant
