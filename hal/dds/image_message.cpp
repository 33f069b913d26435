// SPDX-License-Identifier: Apache-2.0
#include "hal/dds/image_message.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <span>

#include "runtime/base/error.h"

namespace sextant {
namespace {

constexpr std::uint32_t kLeastSide = 16;
constexpr std::uint32_t kMostSide = 16384;
constexpr std::size_t kMostBytes = std::size_t{256} << 20;
constexpr std::size_t kLongestText = 200;

/// How an encoding's bytes become one of our formats.
struct Encoding {
  const char* name;
  ImageKind kind;
  PixelFormat format;
  unsigned bytes_per_value = 1;  ///< swapped where the message is big-endian
  bool has_alpha = false;        ///< a fourth byte that is dropped
};

constexpr std::array kEncodings{
    Encoding{"rgb8", ImageKind::kColour, PixelFormat::kRgb24},
    Encoding{"bgr8", ImageKind::kColour, PixelFormat::kBgr24},
    Encoding{"8UC3", ImageKind::kColour, PixelFormat::kBgr24},  // OpenCV's order
    Encoding{"rgba8", ImageKind::kColour, PixelFormat::kRgb24, 1, true},
    Encoding{"bgra8", ImageKind::kColour, PixelFormat::kBgr24, 1, true},
    Encoding{"mono8", ImageKind::kColour, PixelFormat::kGrey},
    Encoding{"8UC1", ImageKind::kColour, PixelFormat::kGrey},
    Encoding{"yuv422", ImageKind::kColour, PixelFormat::kUyvy},
    Encoding{"uyvy", ImageKind::kColour, PixelFormat::kUyvy},
    Encoding{"yuv422_yuy2", ImageKind::kColour, PixelFormat::kYuyv},
    Encoding{"yuyv", ImageKind::kColour, PixelFormat::kYuyv},
    Encoding{"16UC1", ImageKind::kDepth, PixelFormat::kZ16, 2},
    Encoding{"mono16", ImageKind::kDepth, PixelFormat::kZ16, 2},
    Encoding{"32FC1", ImageKind::kDepth, PixelFormat::kFloat32, 4},
};

/// Text from the wire for a terminal.
std::string printable(const char* text) {
  if (text == nullptr) return "";
  std::string out(text, strnlen(text, 40));
  std::replace_if(
      out.begin(), out.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return out;
}

const Encoding& encoding_of(const char* name, ImageKind kind, const std::string& topic) {
  for (const Encoding& e : kEncodings) {
    if (e.kind == kind && name != nullptr && std::strcmp(e.name, name) == 0) return e;
  }
  std::string known;
  for (const std::string& n : known_encodings(kind)) known += (known.empty() ? "" : ", ") + n;
  throw InputError(topic,
                   fmt::format("the encoding \"{}\" is no {} encoding that is read", printable(name),
                               kind == ImageKind::kColour ? "colour" : "depth"),
                   "let the camera's driver publish one of " + known);
}

void swap_values(std::span<std::byte> bytes, unsigned value_bytes) {
  for (std::size_t i = 0; i + value_bytes <= bytes.size(); i += value_bytes) {
    std::reverse(bytes.begin() + static_cast<std::ptrdiff_t>(i),
                 bytes.begin() + static_cast<std::ptrdiff_t>(i + value_bytes));
  }
}

std::vector<std::byte> without_alpha(std::span<const std::byte> bytes, std::size_t width, std::size_t height,
                                     std::size_t step) {
  std::vector<std::byte> out(width * height * 3);
  std::size_t at = 0;
  for (std::size_t y = 0; y < height; ++y) {
    const std::byte* row = bytes.data() + y * step;
    for (std::size_t x = 0; x < width; ++x) {
      for (std::size_t k = 0; k < 3; ++k) out[at++] = row[4 * x + k];
    }
  }
  return out;
}

}  // namespace

std::vector<std::string> known_encodings(ImageKind kind) {
  std::vector<std::string> names;
  for (const Encoding& e : kEncodings) {
    if (e.kind == kind) names.emplace_back(e.name);
  }
  return names;
}

CaptureTime time_of(std::int32_t sec, std::uint32_t nanosec, const std::string& topic) {
  if (sec < 0 || nanosec >= 1'000'000'000U) throw InputError(topic, "a stamp is no time", "message ignored");
  return CaptureTime(std::chrono::seconds(sec) + std::chrono::nanoseconds(nanosec));
}

std::string frame_of(const char* frame_id, const std::string& topic) {
  if (frame_id == nullptr || strnlen(frame_id, kLongestText + 1) > kLongestText) {
    throw InputError(topic, "a frame_id is absurdly long", "message ignored");
  }
  std::string name(frame_id);
  if (!name.empty() && name.front() == '/') name.erase(0, 1);  // as tf2 does
  return name;
}

RawImage raw_image_of(const ImageMessage& m, ImageKind kind, const CaptureStamp& clocks,
                      const std::string& topic) {
  const Encoding& encoding = encoding_of(m.encoding, kind, topic);
  frame_of(m.header.frame_id, topic);
  if (m.width < kLeastSide || m.height < kLeastSide || m.width > kMostSide || m.height > kMostSide) {
    throw InputError(topic, fmt::format("an image of {} x {} pixels", m.width, m.height),
                     "16..16384 are read");
  }
  const auto width = static_cast<int>(m.width);
  const auto height = static_cast<int>(m.height);
  const std::size_t least =
      encoding.has_alpha ? std::size_t{4} * m.width : least_stride(encoding.format, width);
  if (m.step < least) {
    throw InputError(
        topic,
        fmt::format("a step of {} bytes is too short for {} pixels of {}", m.step, m.width, encoding.name),
        "message ignored");
  }
  const std::size_t bytes = std::size_t{m.step} * m.height;
  if (bytes > kMostBytes || m.data._length != bytes || m.data._buffer == nullptr) {
    throw InputError(topic,
                     fmt::format("{} bytes of data instead of step * height = {}", m.data._length, bytes),
                     "message ignored");
  }
  const auto* data = reinterpret_cast<const std::byte*>(m.data._buffer);
  auto copy = std::make_shared<std::vector<std::byte>>();
  std::size_t stride = m.step;
  if (encoding.has_alpha) {
    *copy = without_alpha({data, bytes}, m.width, m.height, m.step);
    stride = std::size_t{3} * m.width;
  } else {
    copy->assign(data, data + bytes);
  }
  if (m.is_bigendian != 0 && encoding.bytes_per_value > 1) {
    if (stride % encoding.bytes_per_value != 0) throw InputError(topic, "an odd step", "message ignored");
    swap_values(*copy, encoding.bytes_per_value);
  }
  RawImage image;
  image.format = encoding.format;
  image.width = width;
  image.height = height;
  image.stride = stride;
  image.bytes = *copy;
  image.captured = stamp_of(time_of(m.header.stamp.sec, m.header.stamp.nanosec, topic), clocks);
  image.buffer = std::move(copy);
  return image;
}

CameraModel camera_of(const CameraInfoMessage& m, const std::string& topic) {
  const auto require = [&](bool good, const std::string& what, const char* advice) {
    if (!good) throw InputError(topic, what, advice);
  };
  require(m.width <= kMostSide && m.height <= kMostSide, "an absurd image size", "message ignored");
  require(m.binning_x <= 1 && m.binning_y <= 1, "the camera bins pixels", "switch binning off");
  const bool whole =
      (m.roi.width == 0 && m.roi.height == 0) ||
      (m.roi.width == m.width && m.roi.height == m.height && m.roi.x_offset == 0 && m.roi.y_offset == 0);
  require(whole, "the camera sends a region of interest", "let it send whole images");
  require(m.k[0] != 0, "the camera is not calibrated (K is 0)", "calibrate it, or give a calibration file");
  require(m.k[1] == 0 && m.k[3] == 0 && m.k[6] == 0 && m.k[7] == 0 && m.k[8] == 1,
          "K is not [fx, 0, cx, 0, fy, cy, 0, 0, 1]", "message ignored");
  CameraModel camera;
  camera.width = static_cast<int>(m.width);
  camera.height = static_cast<int>(m.height);
  camera.fx = m.k[0];
  camera.cx = m.k[2];
  camera.fy = m.k[4];
  camera.cy = m.k[5];
  const std::string model = printable(m.distortion_model);
  const std::span<const double> d(m.d._buffer, m.d._buffer == nullptr ? 0 : m.d._length);
  const bool straight = std::all_of(d.begin(), d.end(), [](double v) { return v == 0; });
  if (!straight) {
    require(model == "plumb_bob" || model == "rational_polynomial",
            "the distortion model \"" + model + "\" is not supported",
            "publish rectified images, or plumb_bob or rational_polynomial");
    require(d.size() >= 4 && d.size() <= camera.distortion.size(), "an odd number of distortion coefficients",
            "message ignored");
    std::copy(d.begin(), d.end(), camera.distortion.begin());
  }
  camera.check(topic);
  return camera;
}

}  // namespace sextant
