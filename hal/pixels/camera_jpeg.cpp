// SPDX-License-Identifier: Apache-2.0
#include "hal/pixels/camera_jpeg.h"

#include <fmt/format.h>
#include <turbojpeg.h>

#include <memory>
#include <string_view>

#include "runtime/base/error.h"

namespace sextant {
namespace {

struct HandleFree {
  void operator()(void* handle) const { tjDestroy(handle); }
};

/// libjpeg's words for bytes between the last block and the end marker; every block has been decoded then.
bool is_harmless(std::string_view warning) {
  return warning.find("extraneous bytes before marker 0xd9") != std::string_view::npos;
}

}  // namespace

cv::Mat decode_camera_jpeg(std::span<const std::byte> bytes, int width, int height,
                           const std::string& where) {
  // Made once per thread: it holds the decoder's working memory.
  thread_local const std::unique_ptr<void, HandleFree> handle(tjInitDecompress());
  if (!handle) throw InputError(where, "there is no memory to decode a JPEG");
  const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
  int got_width = 0;
  int got_height = 0;
  int subsampling = 0;
  int colour_space = 0;
  if (tjDecompressHeader3(handle.get(), data, bytes.size(), &got_width, &got_height, &subsampling,
                          &colour_space) != 0) {
    throw InputError(where, fmt::format("a damaged JPEG: {}", tjGetErrorStr2(handle.get())));
  }
  if (got_width != width || got_height != height) {
    throw InputError(where, fmt::format("a JPEG of {} x {} pixels instead of {} x {}", got_width, got_height,
                                        width, height));
  }
  cv::Mat rgb(height, width, CV_8UC3);
  if (tjDecompress2(handle.get(), data, bytes.size(), rgb.data, width, 0, height, TJPF_RGB,
                    TJFLAG_LIMITSCANS) != 0 &&
      !is_harmless(tjGetErrorStr2(handle.get()))) {
    throw InputError(where, fmt::format("a damaged JPEG: {}", tjGetErrorStr2(handle.get())));
  }
  return rgb;
}

}  // namespace sextant
