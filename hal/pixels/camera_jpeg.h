// SPDX-License-Identifier: Apache-2.0
// The JPEGs of cameras: often without Huffman tables and with a few stray bytes before the end, which is
// harmless; cut short or damaged, which is not.
#pragma once

#include <cstddef>
#include <opencv2/core.hpp>
#include <span>
#include <string>

namespace sextant {

/// CV_8UC3, RGB. Throws InputError(where) for a JPEG of another size, and for anything that is not a whole,
/// undamaged picture.
cv::Mat decode_camera_jpeg(std::span<const std::byte> bytes, int width, int height, const std::string& where);

}  // namespace sextant
