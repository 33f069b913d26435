// SPDX-License-Identifier: Apache-2.0
#include "offline/synthesize/colour_sensor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "offline/synthesize/noise_field.h"

namespace sextant {
namespace {

/// What was drawn for one image.
struct Shot {
  std::array<double, 3> gain{1, 1, 1};
  double saturation = 1;
  double vignetting = 0;
  std::vector<double> row_gain;
  std::array<double, 1024> tone{};  ///< of light 0..1023/4 grey levels
  double blur = 0.5;
  double motion_px = 0;
  double motion_rad = 0;
  double noise = 1;
};

Shot draw(const cv::Mat& colour, const ColourSensor& sensor, Random& random) {
  Shot shot;
  const cv::Scalar mean = cv::mean(colour);
  const double wanted = random.uniform(sensor.brightness_min, sensor.brightness_max);
  const double exposure =
      std::clamp(wanted / std::max(1.0, (mean[0] + mean[1] + mean[2]) / 3), sensor.gain_min, sensor.gain_max);
  for (double& g : shot.gain) g = exposure * (1 + sensor.white_balance * random.uniform(-1, 1));
  shot.saturation = 1 + sensor.saturation * random.uniform(-1, 1);
  const double gamma = 1 + sensor.gamma * random.uniform(-1, 1);
  for (std::size_t i = 0; i < shot.tone.size(); ++i)
    shot.tone[i] = 255 * std::pow(static_cast<double>(i) / 1020, gamma);
  shot.vignetting = sensor.vignetting * random.uniform();
  // 100 Hz light, rows read within some 10..30 ms.
  const double depth = random.chance(0.4) ? sensor.flicker * random.uniform() : 0;
  const double periods = random.uniform(1, 3);
  const double phase = random.uniform(0, 2 * std::numbers::pi);
  for (int y = 0; y < colour.rows; ++y) {
    shot.row_gain.push_back(1 + depth * std::sin(phase + 2 * std::numbers::pi * periods * y / colour.rows));
  }
  shot.blur = random.uniform(sensor.blur_px_min, sensor.blur_px_max);
  const bool moves = random.chance(sensor.motion_chance);
  shot.motion_px = random.uniform(0, sensor.motion_px);
  if (!moves) shot.motion_px = 0;
  shot.motion_rad = random.uniform(0, std::numbers::pi);
  shot.noise = random.uniform(sensor.noise_min, sensor.noise_max);
  return shot;
}

/// Mean along a line of the given length: a kernel of bilinear weights.
void blur_by_motion(cv::Mat& picture, double length_px, double direction_rad) {
  if (length_px < 0.5) return;
  const int radius = static_cast<int>(std::ceil(length_px / 2)) + 1;
  cv::Mat kernel(2 * radius + 1, 2 * radius + 1, CV_32F, cv::Scalar(0));
  constexpr int kSteps = 33;
  for (int i = 0; i < kSteps; ++i) {
    const double along = length_px * (static_cast<double>(i) / (kSteps - 1) - 0.5);
    const double x = radius + along * std::cos(direction_rad);
    const double y = radius + along * std::sin(direction_rad);
    const int x0 = static_cast<int>(std::floor(x));
    const int y0 = static_cast<int>(std::floor(y));
    for (int dy = 0; dy <= 1; ++dy) {
      for (int dx = 0; dx <= 1; ++dx) {
        kernel.at<float>(y0 + dy, x0 + dx) +=
            static_cast<float>((1 - std::abs(x - x0 - dx)) * (1 - std::abs(y - y0 - dy)) / kSteps);
      }
    }
  }
  cv::filter2D(picture, picture, -1, kernel, {-1, -1}, 0, cv::BORDER_REPLICATE);
}

}  // namespace

cv::Mat apply_colour_sensor(const cv::Mat& colour, const ColourSensor& sensor, std::uint64_t seed) {
  Random random(seed);
  const Shot shot = draw(colour, sensor, random);
  cv::Mat picture;
  colour.convertTo(picture, CV_32FC3);
  if (shot.blur > 0.05) cv::GaussianBlur(picture, picture, {}, shot.blur);
  blur_by_motion(picture, shot.motion_px, shot.motion_rad);
  // Demosaicing leaves luminance noise almost white and colour noise in spots of a few pixels.
  const cv::Mat luminance = smooth_noise(colour.size(), 0.5, random);
  std::array<cv::Mat, 3> chroma;
  for (cv::Mat& channel : chroma) channel = smooth_noise(colour.size(), 1.6, random);
  const cv::Point2d middle((colour.cols - 1) / 2.0, (colour.rows - 1) / 2.0);
  const double corner = std::max(1.0, middle.dot(middle));
  cv::Mat result(colour.size(), CV_8UC3);
  for (int y = 0; y < colour.rows; ++y) {
    const double band = shot.row_gain[static_cast<std::size_t>(y)];
    for (int x = 0; x < colour.cols; ++x) {
      const cv::Point2d from_middle = cv::Point2d(x, y) - middle;
      const double light = band * (1 - shot.vignetting * from_middle.dot(from_middle) / corner);
      const cv::Vec3f in = picture.at<cv::Vec3f>(y, x);
      const double grey = (in[0] + in[1] + in[2]) / 3;
      for (int c = 0; c < 3; ++c) {
        const auto k = static_cast<std::size_t>(c);
        const double linear = (grey + (in[c] - grey) * shot.saturation) * shot.gain[k] * light;
        const double value = shot.tone[static_cast<std::size_t>(std::clamp(4 * linear, 0.0, 1023.0))];
        // Photon noise grows with the root of the signal; gamma flattens it again.
        const double spread = shot.noise * (0.7 + 0.3 * std::sqrt(value / 128));
        const double error = spread * (luminance.at<float>(y, x) + 0.6 * chroma[k].at<float>(y, x));
        result.at<cv::Vec3b>(y, x)[c] = cv::saturate_cast<unsigned char>(value + error);
      }
    }
  }
  return result;
}

}  // namespace sextant
