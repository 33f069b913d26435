// SPDX-License-Identifier: Apache-2.0
// Colour by OpenCV's conversions, straight out of the device's buffer.
#include <fmt/format.h>

#include <opencv2/imgproc.hpp>

#include "hal/pixels/camera_jpeg.h"
#include "hal/pixels/decode.h"
#include "runtime/base/error.h"

namespace sextant {
namespace {

/// A view of the bytes. OpenCV has no read-only matrix; nothing writes through this one.
cv::Mat view(const RawImage& image, int type, std::size_t offset = 0, int divide_by = 1) {
  auto* data = const_cast<std::byte*>(image.bytes.data() + offset);
  return {(image.height + divide_by - 1) / divide_by, (image.width + divide_by - 1) / divide_by, type, data,
          image.stride};
}

void require_even(const RawImage& image, bool height_too, const std::string& where) {
  if (image.width % 2 != 0 || (height_too && image.height % 2 != 0)) {
    throw InputError(where,
                     fmt::format("a {} image of {} x {} pixels: its colour is of pixel pairs",
                                 info_of(image.format).name, image.width, image.height),
                     "choose an even size");
  }
}

}  // namespace

cv::Mat decode_colour(const RawImage& image, const std::string& where) {
  check_layout(image, where);
  cv::Mat rgb;
  switch (image.format) {
    case PixelFormat::kYuyv:
      require_even(image, false, where);
      cv::cvtColor(view(image, CV_8UC2), rgb, cv::COLOR_YUV2RGB_YUY2);
      return rgb;
    case PixelFormat::kUyvy:
      require_even(image, false, where);
      cv::cvtColor(view(image, CV_8UC2), rgb, cv::COLOR_YUV2RGB_UYVY);
      return rgb;
    case PixelFormat::kNv12: {
      require_even(image, true, where);
      const std::size_t chroma = image.stride * static_cast<std::size_t>(image.height);
      cv::cvtColorTwoPlane(view(image, CV_8UC1), view(image, CV_8UC2, chroma, 2), rgb,
                           cv::COLOR_YUV2RGB_NV12);
      return rgb;
    }
    case PixelFormat::kMjpeg:
      return decode_camera_jpeg(image.bytes, image.width, image.height, where);
    case PixelFormat::kRgb24:
      return view(image, CV_8UC3).clone();
    case PixelFormat::kBgr24:
      cv::cvtColor(view(image, CV_8UC3), rgb, cv::COLOR_BGR2RGB);
      return rgb;
    case PixelFormat::kGrey:
      cv::cvtColor(view(image, CV_8UC1), rgb, cv::COLOR_GRAY2RGB);
      return rgb;
    default:
      throw InputError(where, fmt::format("{} is no colour format", info_of(image.format).name),
                       "use it as depth, or choose YUYV, UYVY, NV12, MJPG, RGB3, BGR3 or GREY");
  }
}

}  // namespace sextant
