// SPDX-License-Identifier: Apache-2.0
#include "offline/synthesize/colour_sensor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "offline/synthesize/noise_field.h"

namespace sextant {

cv::Mat apply_colour_sensor(const cv::Mat& colour, const ColourSensor& sensor, std::uint64_t seed) {
  Random random(seed);
  const double exposure = 1 + sensor.exposure * random.uniform(-1, 1);
  std::array<double, 3> gain{};
  for (double& g : gain) g = exposure * (1 + sensor.white_balance * random.uniform(-1, 1));
  const double vignetting = sensor.vignetting * random.uniform();
  const double blur = random.uniform(sensor.blur_px_min, sensor.blur_px_max);
  const double noise = random.uniform(sensor.noise_min, sensor.noise_max);

  cv::Mat picture;
  colour.convertTo(picture, CV_32FC3);
  if (blur > 0.05) cv::GaussianBlur(picture, picture, {}, blur);
  // Demosaicing leaves luminance noise almost white and colour noise in spots of a few pixels.
  const cv::Mat luminance = smooth_noise(colour.size(), 0.5, random);
  std::array<cv::Mat, 3> chroma;
  for (cv::Mat& channel : chroma) channel = smooth_noise(colour.size(), 1.6, random);
  const cv::Point2d middle((colour.cols - 1) / 2.0, (colour.rows - 1) / 2.0);
  const double corner = std::max(1.0, middle.dot(middle));
  cv::Mat result(colour.size(), CV_8UC3);
  for (int y = 0; y < colour.rows; ++y) {
    for (int x = 0; x < colour.cols; ++x) {
      const cv::Point2d from_middle = cv::Point2d(x, y) - middle;
      const double light = 1 - vignetting * from_middle.dot(from_middle) / corner;
      const cv::Vec3f in = picture.at<cv::Vec3f>(y, x);
      for (int c = 0; c < 3; ++c) {
        const double value = in[c] * gain[static_cast<std::size_t>(c)] * light;
        // Photon noise grows with the root of the signal; gamma flattens it again.
        const double spread = noise * (0.7 + 0.3 * std::sqrt(std::max(0.0, value) / 128));
        const double error =
            spread * (luminance.at<float>(y, x) + 0.6 * chroma[static_cast<std::size_t>(c)].at<float>(y, x));
        result.at<cv::Vec3b>(y, x)[c] = cv::saturate_cast<unsigned char>(value + error);
      }
    }
  }
  return result;
}

}  // namespace sextant
