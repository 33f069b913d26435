// SPDX-License-Identifier: Apache-2.0
// What a real colour camera makes of a perfect picture: automatic exposure with its errors, white balance,
// contrast, vignetting, lamps that flicker under a rolling shutter, blur of focus and of motion, noise.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

namespace sextant {

/// How bad the camera is. Everything is drawn per image.
struct ColourSensor {
  double brightness_min =
      75;  ///< the exposure brings the mean of the picture to a level drawn from this range,
  double brightness_max = 150;  ///< grey levels of 255
  double gain_min = 0.5;        ///< as far as these gains allow
  double gain_max = 3.0;
  double white_balance = 0.08;  ///< each channel by 1 +- this
  double saturation = 0.25;     ///< colourfulness by 1 +- this
  double gamma = 0.2;           ///< exponent of the tone curve 1 +- this
  double vignetting = 0.2;      ///< share of light lost in the corners, at most
  double flicker = 0.05;        ///< amplitude of the bands over the rows, at most
  double blur_px_min = 0.4;     ///< sigma of the blur
  double blur_px_max = 1.0;
  double motion_chance = 0.25;  ///< share of the images with motion blur
  double motion_px = 3.5;       ///< its length, at most
  double noise_min = 1.2;       ///< rms of the luminance noise, grey levels of 255
  double noise_max = 4.5;
};

/// CV_8UC3 RGB in and out. Pure: the same seed gives the same image.
cv::Mat apply_colour_sensor(const cv::Mat& colour, const ColourSensor& sensor, std::uint64_t seed);

}  // namespace sextant
