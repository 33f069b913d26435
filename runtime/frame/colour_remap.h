// SPDX-License-Identifier: Apache-2.0
// Moves the pixels of a colour image by a map that is made once and used for every frame: bilinear
// interpolation in whole numbers, so that every processor gives the same image. It exists because OpenCV's
// remap takes several times as long for three channels.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace sextant {

class ColourRemap {
 public:
  ColourRemap() = default;
  /// source_pixels: CV_32FC2, for each pixel of the result where it lies in the source; places outside take
  /// the nearest pixel of the border. source: its size, 2 x 2 to 16384 x 16384 pixels.
  ColourRemap(const cv::Mat& source_pixels, cv::Size source);

  /// image: CV_8UC3 of the source's size. Places are rounded to 1/64 pixel, values to the nearest.
  cv::Mat operator()(const cv::Mat& image) const;

 private:
  /// One pixel of the result: its upper left neighbour in the source, and how far it is from there.
  struct Place {
    std::uint16_t row = 0;
    std::uint16_t offset = 0;  ///< of the left neighbour in its row, bytes
    std::uint8_t right = 0;    ///< 1/64 pixels, 0..64
    std::uint8_t down = 0;     ///< 1/64 pixels, 0..64
  };
  cv::Size source_;
  cv::Size size_;
  std::vector<Place> places_;  ///< row by row
};

}  // namespace sextant
