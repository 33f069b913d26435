// SPDX-License-Identifier: Apache-2.0
// The layouts of pixels that our sources deliver. hal/pixels decodes them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace sextant {

/// Multi-byte values are little endian.
enum class PixelFormat : std::uint8_t {
  // colour
  kYuyv,   ///< Y0 U Y1 V, BT.601 limited range, as all YUV here
  kUyvy,   ///< U Y0 V Y1
  kNv12,   ///< Y plane, then interleaved U V at half size; both planes with the same stride
  kMjpeg,  ///< one JPEG per frame
  kRgb24,
  kBgr24,
  kGrey,  ///< 8 bit
  // depth (or infrared)
  kZ16,       ///< 16 bit distance along the optical axis
  kY16,       ///< 16 bit
  kY10,       ///< 10 bit in 16
  kY12,       ///< 12 bit in 16
  kY10Bpack,  ///< 10 bit, packed without gaps, most significant bit first (gspca's Kinect)
  kY11Bpack,  ///< 11 bit, packed in the same way (the Kinect's own 11-bit stream)
  kFloat32,   ///< metres; NaN and values <= 0 are missing (ROS 32FC1)
};
inline constexpr std::size_t kPixelFormats = 14;

/// What the parts of the hardware layer need to know about a format.
struct PixelFormatInfo {
  PixelFormat format;
  const char* name;      ///< as the configuration writes it: V4L2's four letters where it has some
  std::uint32_t fourcc;  ///< V4L2's, 0: none
  int bits_per_pixel;    ///< of the first plane; 0: compressed
  bool is_depth;         ///< may be read as depth
  bool is_colour;        ///< may be read as colour
};

const PixelFormatInfo& info_of(PixelFormat format);
/// By configuration name, e.g. "YUYV", "Z16 " or "z16".
std::optional<PixelFormat> format_named(std::string_view name);
std::optional<PixelFormat> format_of_fourcc(std::uint32_t fourcc);
/// The four letters of any V4L2 code; unprintable ones become '?'.
std::string fourcc_text(std::uint32_t fourcc);

/// Fewest bytes of a line, and of a whole image of this stride; 0 for compressed formats.
std::size_t least_stride(PixelFormat format, int width);
std::size_t image_bytes(PixelFormat format, int width, int height, std::size_t stride);

}  // namespace sextant
