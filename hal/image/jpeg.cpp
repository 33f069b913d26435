// SPDX-License-Identifier: Apache-2.0
// JPEG through libjpeg-turbo. Progressive files with absurdly many scans are refused (they decode for
// minutes).
#include <turbojpeg.h>

#include <memory>
#include <stdexcept>

#include "hal/image/image_file.h"
#include "runtime/base/error.h"

namespace sextant {
namespace {

constexpr std::size_t kMaxExpansion =
    4096;  ///< pixels per byte: one bit codes at least a part of an 8x8 block

struct HandleFree {
  void operator()(void* handle) const { tjDestroy(handle); }
};

[[noreturn]] void refuse(const std::string& where, tjhandle handle) {
  throw InputError(where, std::string("this JPEG cannot be decoded: ") + tjGetErrorStr2(handle),
                   "the file is damaged; get it again");
}

}  // namespace

cv::Mat decode_jpeg(std::span<const std::byte> bytes, const std::string& where) {
  const std::unique_ptr<void, HandleFree> handle(tjInitDecompress());
  if (!handle) throw InputError(where, "there is no memory to decode this JPEG");
  const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
  int width = 0;
  int height = 0;
  int subsampling = 0;
  int colour_space = 0;
  if (tjDecompressHeader3(handle.get(), data, bytes.size(), &width, &height, &subsampling, &colour_space) !=
      0) {
    refuse(where, handle.get());
  }
  if (width < 1 || height < 1 || width > kMaxImageSide || height > kMaxImageSide ||
      static_cast<std::size_t>(width) * static_cast<std::size_t>(height) > kMaxImagePixels) {
    throw InputError(
        where, "a JPEG of " + std::to_string(width) + " x " + std::to_string(height) + " pixels is too large",
        "shrink it");
  }
  if (static_cast<std::size_t>(width) * static_cast<std::size_t>(height) / kMaxExpansion > bytes.size()) {
    throw InputError(where, "this JPEG is shorter than its size in pixels needs",
                     "the file is damaged; get it again");
  }
  cv::Mat image(height, width, CV_8UC3);
  if (tjDecompress2(handle.get(), data, bytes.size(), image.data, width, 0, height, TJPF_RGB,
                    TJFLAG_LIMITSCANS | TJFLAG_STOPONWARNING) != 0) {
    refuse(where, handle.get());
  }
  return image;
}

std::vector<std::byte> encode_jpeg(const cv::Mat& image, int quality) {
  if (image.type() != CV_8UC3 || image.empty() || image.cols > kMaxImageSide || image.rows > kMaxImageSide)
    throw std::invalid_argument("encode_jpeg wants a CV_8UC3 image");
  const std::unique_ptr<void, HandleFree> handle(tjInitCompress());
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  if (!handle || tjCompress2(handle.get(), image.data, image.cols, static_cast<int>(image.step), image.rows,
                             TJPF_RGB, &bytes, &size, TJSAMP_444, quality, 0) != 0) {
    tjFree(bytes);
    throw std::runtime_error(std::string("cannot encode a JPEG: ") + tjGetErrorStr2(handle.get()));
  }
  const auto* first = reinterpret_cast<const std::byte*>(bytes);
  std::vector<std::byte> result(first, first + size);
  tjFree(bytes);
  return result;
}

}  // namespace sextant
