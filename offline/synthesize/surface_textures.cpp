// SPDX-License-Identifier: Apache-2.0
// The rest of what tables, floors and walls are covered with.
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "offline/synthesize/noise_field.h"
#include "offline/synthesize/textures.h"

namespace sextant {
namespace {

cv::Scalar ink(const Eigen::Vector3d& colour) {
  return {255 * colour.x(), 255 * colour.y(), 255 * colour.z()};
}

/// Multiplies every pixel by 1 + strength * field.
void soil(cv::Mat& image, const cv::Mat& field, double strength) {
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const double factor = 1 + strength * field.at<float>(y, x);
      for (int c = 0; c < 3; ++c) {
        unsigned char& v = image.at<cv::Vec3b>(y, x)[c];
        v = cv::saturate_cast<unsigned char>(v * factor);
      }
    }
  }
}

}  // namespace

cv::Mat checker_texture(const cv::Size& size, Random& random) {
  const cv::Scalar light = ink(random_colour({0, 1}, {0, 0.3}, {0.75, 0.98}, random));
  const cv::Scalar dark = ink(random_colour({0, 1}, {0.1, 0.8}, {0.15, 0.55}, random));
  cv::Mat image(size, CV_8UC3, light);
  const int side = size.width / random.integer(6, 22);
  for (int y = 0; y * side < size.height; ++y) {
    for (int x = y % 2; x * side < size.width; x += 2)
      cv::rectangle(image, {x * side, y * side}, {(x + 1) * side - 1, (y + 1) * side - 1}, dark, cv::FILLED);
  }
  soil(image, cloudy_noise(size, 12, 3, random), 0.06);
  return image;
}

cv::Mat striped_texture(const cv::Size& size, Random& random) {
  cv::Mat image(size, CV_8UC3, ink(random_colour({0, 1}, {0, 0.6}, {0.4, 0.95}, random)));
  const bool crossed = random.chance(0.5);
  const int period = size.width / random.integer(4, 18);
  const int bands = random.integer(1, 3);
  for (int b = 0; b < bands; ++b) {
    const cv::Scalar colour = ink(random_colour({0, 1}, {0, 0.9}, {0.15, 0.95}, random));
    const int offset = random.integer(0, period - 1);
    const int width = std::max(2, static_cast<int>(period * random.uniform(0.05, 0.35)));
    for (int at = offset; at < size.width; at += period) {
      cv::rectangle(image, {at, 0}, {at + width, size.height}, colour, cv::FILLED);
      if (crossed) cv::rectangle(image, {0, at}, {size.width, at + width / 2}, colour, cv::FILLED);
    }
  }
  soil(image, white_noise(size, random), 0.03);
  return image;
}

cv::Mat carpet_texture(const cv::Size& size, Random& random) {
  cv::Mat image(size, CV_8UC3, ink(random_colour({0, 1}, {0.05, 0.6}, {0.2, 0.75}, random)));
  soil(image, smooth_noise(size, 1.2, random), random.uniform(0.08, 0.2));
  soil(image, cloudy_noise(size, 30, 3, random), 0.06);
  return image;
}

cv::Mat terrazzo_texture(const cv::Size& size, Random& random) {
  cv::Mat image(size, CV_8UC3, ink(random_colour({0, 1}, {0, 0.25}, {0.45, 0.95}, random)));
  const int chips = random.integer(300, 1500);
  std::vector<cv::Scalar> colours;
  for (int i = random.integer(2, 5); i > 0; --i)
    colours.push_back(ink(random_colour({0, 1}, {0, 0.6}, {0.1, 0.95}, random)));
  for (int i = 0; i < chips; ++i) {
    const cv::Point middle(random.integer(0, size.width), random.integer(0, size.height));
    std::vector<cv::Point> corners;
    const double radius = size.width / random.uniform(60, 250);
    for (int k = 0; k < 5; ++k) {
      const double angle = 1.2566 * k + random.uniform(-0.4, 0.4);
      const double reach = radius * random.uniform(0.5, 1);
      corners.emplace_back(middle + cv::Point(static_cast<int>(reach * std::cos(angle)),
                                              static_cast<int>(reach * std::sin(angle))));
    }
    const int which = random.integer(0, static_cast<int>(colours.size()) - 1);
    cv::fillConvexPoly(image, corners, colours[static_cast<std::size_t>(which)], cv::LINE_AA);
  }
  return image;
}

cv::Mat page_texture(const cv::Size& size, Random& random) {
  cv::Mat image(size, CV_8UC3, ink(random_colour({0.05, 0.15}, {0, 0.12}, {0.85, 0.99}, random)));
  const cv::Scalar black(40, 40, 46);
  const int columns = random.integer(1, 3);
  const int line = std::max(3, size.height / random.integer(28, 60));
  const int gutter = size.width / 20;
  const int wide = (size.width - gutter) / columns - gutter;
  for (int c = 0; c < columns; ++c) {
    const int left = gutter + c * (wide + gutter);
    int y = size.height / 15;
    if (random.chance(0.4)) {
      cv::rectangle(image, {left, y}, {left + wide, y + size.height / 6},
                    ink(random_colour({0, 1}, {0.1, 0.9}, {0.2, 0.9}, random)), cv::FILLED);
      y += size.height / 5;
    }
    for (; y < size.height - size.height / 15; y += line) {
      if (random.chance(0.1)) continue;
      for (int x = left; x < left + wide;) {
        const int word = random.integer(line, 4 * line);
        cv::rectangle(image, {x, y}, {std::min(x + word, left + wide), y + line / 2}, black, cv::FILLED);
        x += word + std::max(2, line / 2);
      }
    }
  }
  return image;
}

cv::Mat table_texture(const cv::Size& size, Random& random) {
  switch (random.integer(0, 11)) {
    case 0:
    case 1:
    case 2:
    case 3:
      return wood_texture(size, random);
    case 4:
    case 5:
      return plain_texture(size, random);
    case 6:
      return cloth_texture(size, random);
    case 7:
      return checker_texture(size, random);
    case 8:
      return striped_texture(size, random);
    case 9:
      return terrazzo_texture(size, random);
    case 10:
      return carpet_texture(size, random);
    default:
      return stone_texture(size, random);
  }
}

cv::Mat floor_texture(const cv::Size& size, Random& random) {
  switch (random.integer(0, 4)) {
    case 0:
      return wood_texture(size, random);
    case 1:
      return tile_texture(size, random);
    case 2:
      return carpet_texture(size, random);
    case 3:
      return terrazzo_texture(size, random);
    default:
      return checker_texture(size, random);
  }
}

cv::Mat wall_texture(const cv::Size& size, Random& random) {
  switch (random.integer(0, 5)) {
    case 0:
      return tile_texture(size, random);
    case 1:
      return striped_texture(size, random);
    case 2:
      return stone_texture(size, random);
    default:
      return plain_texture(size, random);
  }
}

}  // namespace sextant
