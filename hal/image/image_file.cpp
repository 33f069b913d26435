// SPDX-License-Identifier: Apache-2.0
#include "hal/image/image_file.h"

#include "hal/image/file_bytes.h"
#include "runtime/base/error.h"

namespace sextant {

cv::Mat decode_image(std::span<const std::byte> bytes, const std::string& where) {
  if (bytes.size() >= 2 && bytes[0] == std::byte{0x89} && bytes[1] == std::byte{'P'}) {
    return decode_png(bytes, where);
  }
  if (bytes.size() >= 2 && bytes[0] == std::byte{0xFF} && bytes[1] == std::byte{0xD8}) {
    return decode_jpeg(bytes, where);
  }
  throw InputError(where, "this is neither a PNG nor a JPEG image", "convert it to one of these");
}

cv::Mat read_colour_image(const std::filesystem::path& file) {
  cv::Mat image = decode_image(read_file_bytes(file, kMaxImageFileBytes), file.string());
  if (image.type() != CV_8UC3) {
    throw InputError(file.string(), "has 16-bit grey pixels, but this should be the colour image",
                     "give an 8-bit image");
  }
  return image;
}

cv::Mat read_depth_image(const std::filesystem::path& file) {
  cv::Mat image = decode_image(read_file_bytes(file, kMaxImageFileBytes), file.string());
  if (image.type() != CV_16UC1) {
    throw InputError(file.string(), "is no depth image: its pixels are not 16-bit grey",
                     "give a PNG with one 16-bit channel");
  }
  return image;
}

void write_png(const std::filesystem::path& file, const cv::Mat& image, int level) {
  write_file_bytes(file, encode_png(image, level));
}

}  // namespace sextant
