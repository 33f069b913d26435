// SPDX-License-Identifier: Apache-2.0
#include "offline/synthesize/textures.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "offline/synthesize/noise_field.h"

namespace sextant {
namespace {

/// Colour at each pixel: base * (1 + strength * field), clipped.
cv::Mat shaded(const cv::Mat& field, const Eigen::Vector3d& base, double strength) {
  cv::Mat image(field.size(), CV_8UC3);
  for (int y = 0; y < field.rows; ++y) {
    for (int x = 0; x < field.cols; ++x) {
      const double factor = 255 * std::max(0.0, 1 + strength * field.at<float>(y, x));
      for (int c = 0; c < 3; ++c)
        image.at<cv::Vec3b>(y, x)[c] = cv::saturate_cast<unsigned char>(base[c] * factor);
    }
  }
  return image;
}

cv::Scalar random_ink(Random& random) {
  const Eigen::Vector3d c = random_colour({0, 1}, {0.1, 0.95}, {0.1, 0.98}, random);
  return {255 * c.x(), 255 * c.y(), 255 * c.z()};
}

}  // namespace

Eigen::Vector3d colour_from_hsv(double hue, double saturation, double value) {
  const auto channel = [&](double n) {
    const double k = std::fmod(n + hue * 6, 6.0);
    return value * (1 - saturation * std::max(0.0, std::min({k, 4 - k, 1.0})));
  };
  return {channel(5), channel(3), channel(1)};
}

Eigen::Vector3d random_colour(const Range& hue, const Range& saturation, const Range& value, Random& random) {
  const double h = random.in(hue);
  const double s = random.in(saturation);
  const double v = random.in(value);
  return colour_from_hsv(h, s, v);
}

cv::Mat cloudy_noise(const cv::Size& size, double sigma_px, int octaves, Random& random) {
  cv::Mat sum(size, CV_32FC1, cv::Scalar(0));
  double variance = 0;
  double weight = 1;
  for (int i = 0; i < octaves; ++i) {
    sum += smooth_noise(size, sigma_px, random) * weight;
    variance += weight * weight;
    weight *= 0.55;
    sigma_px /= 2;
  }
  return sum / std::sqrt(variance);
}

cv::Mat wood_texture(const cv::Size& size, Random& random) {
  const Eigen::Vector3d base = random_colour({0.05, 0.11}, {0.25, 0.6}, {0.35, 0.85}, random);
  const int board = random.chance(0.5) ? size.height : size.height / random.integer(4, 9);
  // Grain: noise made short across and long along the boards.
  const cv::Size narrow(std::max(8, size.width / 20), size.height);
  cv::Mat grain;
  cv::resize(cloudy_noise(narrow, 2.5, 3, random), grain, size, 0, 0, cv::INTER_CUBIC);
  const cv::Mat waves = smooth_noise(size, 40, random);
  cv::Mat field(size, CV_32FC1);
  const double rings = random.uniform(0.05, 0.2);
  std::vector<double> tone(static_cast<std::size_t>(size.height / board + 1));
  for (double& t : tone) t = 0.06 * random.normal();
  for (int y = 0; y < size.height; ++y) {
    const bool joint = board < size.height && y % board < 2;
    for (int x = 0; x < size.width; ++x) {
      const double ring = std::sin(rings * y + 2.5 * waves.at<float>(y, x));
      field.at<float>(y, x) =
          static_cast<float>(0.05 * ring + 0.07 * grain.at<float>(y, x) +
                             tone[static_cast<std::size_t>(y / board)] - (joint ? 0.35 : 0));
    }
  }
  return shaded(field, base, 1);
}

cv::Mat plain_texture(const cv::Size& size, Random& random) {
  const Eigen::Vector3d base = random_colour({0, 1}, {0, 0.35}, {0.3, 0.92}, random);
  const cv::Mat clouds = cloudy_noise(size, size.width / 8.0, 3, random);
  const cv::Mat speckle = white_noise(size, random);
  return shaded(clouds + speckle * 0.35, base, random.uniform(0.015, 0.05));
}

cv::Mat cloth_texture(const cv::Size& size, Random& random) {
  const Eigen::Vector3d base = random_colour({0, 1}, {0.2, 0.8}, {0.35, 0.9}, random);
  const double period = size.width / random.uniform(8, 30);
  const double contrast = random.uniform(0.08, 0.3);
  const cv::Mat weave = white_noise(size, random);
  cv::Mat field(size, CV_32FC1);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const bool odd_row = std::fmod(y, 2 * period) < period;
      const bool odd_column = std::fmod(x, 2 * period) < period;
      field.at<float>(y, x) = static_cast<float>((odd_row ? contrast : 0) - (odd_column ? contrast : 0)) +
                              0.04F * weave.at<float>(y, x);
    }
  }
  return shaded(field, base, 1);
}

cv::Mat stone_texture(const cv::Size& size, Random& random) {
  const Eigen::Vector3d base = random_colour({0, 0.15}, {0, 0.25}, {0.35, 0.9}, random);
  const cv::Mat clouds = cloudy_noise(size, size.width / 10.0, 5, random);
  cv::Mat field(size, CV_32FC1);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const float c = clouds.at<float>(y, x);
      field.at<float>(y, x) = 0.05F * c - 0.22F * std::exp(-std::abs(c) * 14);
    }
  }
  return shaded(field, base, 1);
}

cv::Mat tile_texture(const cv::Size& size, Random& random) {
  const Eigen::Vector3d base = random_colour({0, 0.12}, {0.05, 0.6}, {0.35, 0.85}, random);
  const int height = size.height / random.integer(8, 20);
  const int width = random.chance(0.5) ? height : 2 * height;
  const bool offset = random.chance(0.6);
  const cv::Mat clouds = cloudy_noise(size, 20, 3, random);
  cv::Mat field(size, CV_32FC1);
  for (int y = 0; y < size.height; ++y) {
    const int row = y / height;
    for (int x = 0; x < size.width; ++x) {
      const int shifted = x + (offset && row % 2 ? width / 2 : 0);
      const bool joint = y % height < 3 || shifted % width < 3;
      // Each tile its own tone, from its number alone.
      const double tone = static_cast<double>(derived_seed(static_cast<std::uint64_t>(row) * 1009,
                                                           static_cast<std::uint64_t>(shifted / width)) >>
                                              40) /
                              (1 << 24) -
                          0.5;
      field.at<float>(y, x) =
          static_cast<float>(0.04 * clouds.at<float>(y, x) + 0.15 * tone + (joint ? 0.25 : 0));
    }
  }
  return shaded(field, base, 1);
}

cv::Mat print_texture(const cv::Size& size, Random& random) {
  cv::Mat image(size, CV_8UC3, random_ink(random));
  const auto anywhere = [&] {
    return cv::Point{random.integer(0, size.width - 1), random.integer(0, size.height - 1)};
  };
  for (int i = random.integer(1, 4); i > 0; --i) {
    const cv::Point corner = anywhere();
    const cv::Point opposite = anywhere();
    cv::rectangle(image, corner, opposite, random_ink(random), cv::FILLED);
  }
  if (random.chance(0.6)) {
    const cv::Point centre = anywhere();
    const int radius = random.integer(size.width / 12, size.width / 4);
    cv::circle(image, centre, radius, random_ink(random), cv::FILLED, cv::LINE_AA);
  }
  if (random.chance(0.4)) {
    const int step = random.integer(size.width / 20, size.width / 6);
    const cv::Scalar ink = random_ink(random);
    for (int at = 0; at < size.width; at += 2 * step)
      cv::rectangle(image, {at, 0}, {at + step, size.height / 5}, ink, cv::FILLED);
  }
  // Lines of words.
  const cv::Scalar ink = random_ink(random);
  const int left = random.integer(0, size.width / 3);
  const int letter = std::max(3, size.height / random.integer(18, 40));
  for (int row = random.integer(letter, size.height / 2); row + letter < size.height && random.chance(0.93);
       row += 2 * letter) {
    for (int at = left; at < size.width - letter;) {
      const int length = random.integer(2, 8) * letter / 2;
      cv::rectangle(image, {at, row}, {std::min(at + length, size.width - 1), row + letter}, ink, cv::FILLED);
      at += length + letter;
      if (random.chance(0.12)) break;
    }
  }
  return image;
}

}  // namespace sextant
