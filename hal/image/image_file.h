// SPDX-License-Identifier: Apache-2.0
// Image files: PNG and JPEG in, PNG out, with bounded sizes; libspng and libjpeg-turbo do the decoding.
// Files are hostile until decoded: every defect becomes an InputError that names the file.
#pragma once

#include <cstddef>
#include <filesystem>
#include <opencv2/core.hpp>
#include <span>
#include <string>
#include <vector>

namespace sextant {

inline constexpr int kMaxImageSide = 16384;                            ///< pixels
inline constexpr std::size_t kMaxImagePixels = std::size_t{64} << 20;  ///< width * height

/// Decodes the bytes of a PNG or JPEG (told by their first bytes). 16-bit grey PNG gives CV_16UC1, every
/// other image CV_8UC3 in RGB order (grey and palette expanded, alpha dropped). Throws InputError(where).
cv::Mat decode_image(std::span<const std::byte> bytes, const std::string& where);
/// As decode_image, for bytes that must be a PNG.
cv::Mat decode_png(std::span<const std::byte> bytes, const std::string& where);
/// As decode_image, for bytes that must be a JPEG. A truncated or damaged one is an error, never half a
/// picture.
cv::Mat decode_jpeg(std::span<const std::byte> bytes, const std::string& where);

/// CV_8UC3, RGB. Throws InputError(file), also for 16-bit grey.
cv::Mat read_colour_image(const std::filesystem::path& file);
/// CV_16UC1. Throws InputError(file), also for anything but a 16-bit grey PNG.
cv::Mat read_depth_image(const std::filesystem::path& file);

/// Bytes of a PNG of a CV_8UC3 (RGB) or CV_16UC1 image with 1..kMaxImageSide pixels a side. The same image
/// gives the same bytes. compression: zlib's level, 0 (none) to 9; 1 is fast enough for a camera's frames.
std::vector<std::byte> encode_png(const cv::Mat& image, int compression = 6);
/// Writes encode_png(image) (renamed into place). Throws InputError(file) where it cannot.
void write_png(const std::filesystem::path& file, const cv::Mat& image);

}  // namespace sextant
