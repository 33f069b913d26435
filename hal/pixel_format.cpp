// SPDX-License-Identifier: Apache-2.0
#include "hal/pixel_format.h"

#include <algorithm>
#include <array>
#include <cctype>

namespace sextant {
namespace {

constexpr std::uint32_t code(const char (&letters)[5]) {
  std::uint32_t value = 0;
  for (int i = 3; i >= 0; --i) value = value << 8 | static_cast<unsigned char>(letters[i]);
  return value;
}

using enum PixelFormat;
constexpr std::array<PixelFormatInfo, kPixelFormats> kInfos{{
    {kYuyv, "YUYV", code("YUYV"), 16, false, true},
    {kUyvy, "UYVY", code("UYVY"), 16, false, true},
    {kNv12, "NV12", code("NV12"), 8, false, true},
    {kMjpeg, "MJPG", code("MJPG"), 0, false, true},
    {kRgb24, "RGB3", code("RGB3"), 24, false, true},
    {kBgr24, "BGR3", code("BGR3"), 24, false, true},
    {kGrey, "GREY", code("GREY"), 8, false, true},
    {kZ16, "Z16", code("Z16 "), 16, true, false},
    {kY16, "Y16", code("Y16 "), 16, true, false},
    {kY10, "Y10", code("Y10 "), 16, true, false},
    {kY12, "Y12", code("Y12 "), 16, true, false},
    {kY10Bpack, "Y10B", code("Y10B"), 10, true, false},
    {kY11Bpack, "Y11B", code("Y11B"), 11, true, false},
    {kFloat32, "32FC1", 0, 32, true, false},
}};

std::string upper_trimmed(std::string_view text) {
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(),
                 [](char c) { return static_cast<char>(std::toupper(static_cast<unsigned char>(c))); });
  return out;
}

}  // namespace

const PixelFormatInfo& info_of(PixelFormat format) { return kInfos.at(static_cast<std::size_t>(format)); }

std::optional<PixelFormat> format_named(std::string_view name) {
  const std::string wanted = upper_trimmed(name);
  for (const PixelFormatInfo& info : kInfos) {
    if (wanted == info.name) return info.format;
  }
  if (wanted == "MJPEG") return kMjpeg;
  if (wanted == "RGB24" || wanted == "RGB8") return kRgb24;
  if (wanted == "BGR24" || wanted == "BGR8") return kBgr24;
  return std::nullopt;
}

std::optional<PixelFormat> format_of_fourcc(std::uint32_t fourcc) {
  if (fourcc == code("JPEG")) return kMjpeg;
  for (const PixelFormatInfo& info : kInfos) {
    if (info.fourcc != 0 && info.fourcc == fourcc) return info.format;
  }
  return std::nullopt;
}

std::string fourcc_text(std::uint32_t fourcc) {
  std::string text;
  for (int i = 0; i < 4; ++i) {
    const char c = static_cast<char>(fourcc >> (8 * i) & 0x7f);
    text += c >= ' ' && c <= '~' ? c : '?';
  }
  return text;
}

std::size_t least_stride(PixelFormat format, int width) {
  return (static_cast<std::size_t>(width) * static_cast<std::size_t>(info_of(format).bits_per_pixel) + 7) / 8;
}

std::size_t image_bytes(PixelFormat format, int width, int height, std::size_t stride) {
  if (info_of(format).bits_per_pixel == 0) return 0;
  const auto lines = static_cast<std::size_t>(height);
  const std::size_t last_line = least_stride(format, width);
  // The padding after the last line need not be there.
  if (format == kNv12) return stride * (lines + (lines + 1) / 2 - 1) + (last_line + 1) / 2 * 2;
  return lines == 0 ? 0 : stride * (lines - 1) + last_line;
}

}  // namespace sextant
