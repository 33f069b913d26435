// SPDX-License-Identifier: Apache-2.0
// Raw depth values -> metres. The Kinect's disparity formula is the one of S. Magnenat's calibration, which
// OpenKinect publishes: 1 / (-0.0030711016 v + 3.3309495161) metres, v of 11 bits, 2047 = nothing seen.
#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <vector>

#include "hal/pixels/decode.h"
#include "runtime/base/error.h"

namespace sextant {
namespace {

/// Reads values of `bits` bits, most significant first, without gaps within a line.
void unpack_line(const std::byte* in, int bits, int count, std::uint16_t* out) {
  std::uint32_t pool = 0;
  int held = 0;
  for (int i = 0; i < count; ++i) {
    while (held < bits) {
      pool = pool << 8 | std::to_integer<std::uint32_t>(*in++);
      held += 8;
    }
    held -= bits;
    out[i] = static_cast<std::uint16_t>(pool >> held & ((1U << bits) - 1));
  }
}

int value_bits(PixelFormat format) {
  switch (format) {
    case PixelFormat::kY10:
    case PixelFormat::kY10Bpack:
      return 10;
    case PixelFormat::kY11Bpack:
      return 11;
    case PixelFormat::kY12:
      return 12;
    default:
      return 16;
  }
}

/// Metres of every possible value.
std::vector<float> table_of(PixelFormat format, const DepthScale& scale, const std::string& where) {
  const int bits = value_bits(format);
  std::vector<float> metres(65536, 0.0F);
  const bool kinect = scale.encoding == DepthScale::Encoding::kKinectDisparity;
  if (kinect && bits != 10 && bits != 11) {
    throw InputError(where, fmt::format("{} holds no Kinect disparity", info_of(format).name),
                     "set the depth encoding to linear");
  }
  for (std::uint32_t v = 1; v < 1U << bits; ++v) {
    double m = v * scale.metres_per_unit;
    if (kinect) {
      const double v11 = bits == 10 ? 2.0 * v + 0.5 : v;
      const double inverse = -0.0030711016 * v11 + 3.3309495161;
      const bool nothing = v == (1U << bits) - 1;
      m = nothing || inverse <= 0 ? 0 : 1 / inverse;
    }
    if (m >= scale.nearest_m && m <= scale.farthest_m) metres[v] = static_cast<float>(m);
  }
  return metres;
}

cv::Mat decode_float(const RawImage& image, const DepthScale& scale, const std::string& where) {
  check_layout(image, where);
  cv::Mat depth(image.height, image.width, CV_32FC1);
  for (int y = 0; y < image.height; ++y) {
    auto* out = depth.ptr<float>(y);
    std::memcpy(out, image.bytes.data() + static_cast<std::size_t>(y) * image.stride,
                static_cast<std::size_t>(image.width) * sizeof(float));
    for (int x = 0; x < image.width; ++x) {
      // Written so that a NaN is missing.
      const bool there = out[x] > 0 && out[x] >= scale.nearest_m && out[x] <= scale.farthest_m;
      if (!there) out[x] = 0;
    }
  }
  return depth;
}

}  // namespace

cv::Mat decode_values(const RawImage& image, const std::string& where) {
  const PixelFormatInfo& info = info_of(image.format);
  if (!info.is_depth || image.format == PixelFormat::kFloat32) {
    throw InputError(where, fmt::format("{} holds no raw depth values", info.name),
                     "choose Z16, Y16, Y10, Y12, Y10B or Y11B");
  }
  check_layout(image, where);
  cv::Mat values(image.height, image.width, CV_16UC1);
  for (int y = 0; y < image.height; ++y) {
    const std::byte* line = image.bytes.data() + static_cast<std::size_t>(y) * image.stride;
    auto* out = values.ptr<std::uint16_t>(y);
    if (info.bits_per_pixel == 16) {
      std::memcpy(out, line, static_cast<std::size_t>(image.width) * 2);
    } else {
      unpack_line(line, info.bits_per_pixel, image.width, out);
    }
  }
  return values;
}

cv::Mat decode_depth(const RawImage& image, const DepthScale& scale, const std::string& where) {
  if (image.format == PixelFormat::kFloat32) return decode_float(image, scale, where);
  const cv::Mat values = decode_values(image, where);
  cv::Mat depth(image.height, image.width, CV_32FC1);
  const std::vector<float> metres = table_of(image.format, scale, where);
  for (int y = 0; y < image.height; ++y) {
    const auto* in = values.ptr<std::uint16_t>(y);
    auto* out = depth.ptr<float>(y);
    for (int x = 0; x < image.width; ++x) out[x] = metres[in[x]];
  }
  return depth;
}

}  // namespace sextant
