// SPDX-License-Identifier: Apache-2.0
// Raw images of devices -> the two kinds of image that the rest of Sextant knows: RGB colour, and depth in
// metres. The bytes are hostile: sizes are checked before anything is read.
#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "hal/image_source.h"

namespace sextant {

/// How raw depth values become metres along the optical axis.
struct DepthScale {
  enum class Encoding : std::uint8_t {
    kLinear,           ///< value * metres_per_unit
    kKinectDisparity,  ///< the first Kinect's 11-bit disparity (Y10 and Y10B: its upper 10 bits)
  };
  Encoding encoding = Encoding::kLinear;
  double metres_per_unit = 0.001;
  double nearest_m = 0;     ///< nearer is missing
  double farthest_m = 100;  ///< farther is missing
};

/// Throws InputError(where) unless size, stride and bytes fit the format.
void check_layout(const RawImage& image, const std::string& where);

/// CV_8UC3, RGB, of its own memory; grey is repeated into all three. YUV is BT.601 limited range, as UVC and
/// V4L2 define it. Throws InputError(where) for depth formats, bytes that do not fit, and damaged JPEGs.
cv::Mat decode_colour(const RawImage& image, const std::string& where);

/// CV_16UC1, the raw values, of its own memory. Throws InputError(where) for colour formats, kFloat32, and
/// bytes that do not fit.
cv::Mat decode_values(const RawImage& image, const std::string& where);

/// CV_32FC1, metres along the optical axis, 0 where missing. Throws as decode_values; kFloat32 is taken as it
/// is.
cv::Mat decode_depth(const RawImage& image, const DepthScale& scale, const std::string& where);

}  // namespace sextant
