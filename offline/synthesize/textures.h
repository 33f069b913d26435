// SPDX-License-Identifier: Apache-2.0
// Procedural pictures for tables, walls, floors and packages: enough structure that edges and smooth areas
// occur as they do in rooms. All CV_8UC3 RGB.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "offline/synthesize/random.h"

namespace sextant {

/// Sum of smooth noise of sigma, sigma/2, sigma/4, ...; unit variance; CV_32FC1.
cv::Mat cloudy_noise(const cv::Size& size, double sigma_px, int octaves, Random& random);

/// Boards with grain along x.
cv::Mat wood_texture(const cv::Size& size, Random& random);
/// One colour with faint clouds and speckle (laminate, plaster).
cv::Mat plain_texture(const cv::Size& size, Random& random);
/// Woven squares.
cv::Mat cloth_texture(const cv::Size& size, Random& random);
/// Stone with veins.
cv::Mat stone_texture(const cv::Size& size, Random& random);
/// Tiles or bricks with joints.
cv::Mat tile_texture(const cv::Size& size, Random& random);
/// A package's print: fields, stripes, discs and lines of "text".
cv::Mat print_texture(const cv::Size& size, Random& random);

/// Two colours of squares, as on a board or a cloth.
cv::Mat checker_texture(const cv::Size& size, Random& random);
/// Bands of colour, along or crossed.
cv::Mat striped_texture(const cv::Size& size, Random& random);
/// Speckled pile.
cv::Mat carpet_texture(const cv::Size& size, Random& random);
/// Chips of a few colours in a plain ground.
cv::Mat terrazzo_texture(const cv::Size& size, Random& random);
/// A printed sheet: columns of words, here and there a picture.
cv::Mat page_texture(const cv::Size& size, Random& random);

/// What tables, floors and walls are covered with: one of the above.
cv::Mat table_texture(const cv::Size& size, Random& random);
cv::Mat floor_texture(const cv::Size& size, Random& random);
cv::Mat wall_texture(const cv::Size& size, Random& random);

/// RGB 0..1 from hue 0..1, saturation 0..1, value 0..1.
Eigen::Vector3d colour_from_hsv(double hue, double saturation, double value);
/// Hue, saturation and value drawn from their ranges, in this order.
Eigen::Vector3d random_colour(const Range& hue, const Range& saturation, const Range& value, Random& random);

}  // namespace sextant
