// SPDX-License-Identifier: Apache-2.0
#include "offline/mesh/texture.h"

#include <spng.h>
#include <turbojpeg.h>

#include <cstring>
#include <memory>

#include "runtime/base/error.h"

namespace sextant {
namespace {

constexpr const char* kAdvice = "give an RGB PNG or JPEG of at most 8192 x 8192 pixels";

cv::Mat decode_png(std::span<const std::byte> bytes, const std::string& where) {
  const std::unique_ptr<spng_ctx, void (*)(spng_ctx*)> context(spng_ctx_new(0), spng_ctx_free);
  if (!context) throw InputError(where, "no memory for this PNG");
  const auto check = [&](int code) {
    if (code != 0) throw InputError(where, std::string("bad PNG: ") + spng_strerror(code), kAdvice);
  };
  check(spng_set_image_limits(context.get(), kMaxTextureSide, kMaxTextureSide));
  check(spng_set_chunk_limits(context.get(), std::size_t{1} << 24, std::size_t{1} << 25));
  check(spng_set_png_buffer(context.get(), bytes.data(), bytes.size()));
  spng_ihdr header{};
  check(spng_get_ihdr(context.get(), &header));
  std::size_t size = 0;
  check(spng_decoded_image_size(context.get(), SPNG_FMT_RGB8, &size));
  cv::Mat image(static_cast<int>(header.height), static_cast<int>(header.width), CV_8UC3);
  if (size != image.total() * image.elemSize()) throw InputError(where, "bad PNG: sizes disagree", kAdvice);
  check(spng_decode_image(context.get(), image.data, size, SPNG_FMT_RGB8, 0));
  return image;
}

cv::Mat decode_jpeg(std::span<const std::byte> bytes, const std::string& where) {
  const std::unique_ptr<void, int (*)(void*)> context(tjInitDecompress(), tjDestroy);
  if (!context) throw InputError(where, "no memory for this JPEG");
  const auto check = [&](int code) {
    if (code != 0) {
      throw InputError(where, std::string("bad JPEG: ") + tjGetErrorStr2(context.get()), kAdvice);
    }
  };
  const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
  int width = 0;
  int height = 0;
  int subsampling = 0;
  int colours = 0;
  check(tjDecompressHeader3(context.get(), data, bytes.size(), &width, &height, &subsampling, &colours));
  if (width < 1 || height < 1 || width > kMaxTextureSide || height > kMaxTextureSide) {
    throw InputError(where, "a JPEG of " + std::to_string(width) + " x " + std::to_string(height) + " pixels",
                     kAdvice);
  }
  cv::Mat image(height, width, CV_8UC3);
  // The accurate transform is the same on every processor; the scan limit stops progressive bombs.
  check(tjDecompress2(context.get(), data, bytes.size(), image.data, width, static_cast<int>(image.step),
                      height, TJPF_RGB, TJFLAG_ACCURATEDCT | TJFLAG_LIMITSCANS));
  return image;
}

}  // namespace

cv::Mat decode_texture(std::span<const std::byte> bytes, const std::string& where) {
  constexpr unsigned char kPng[] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  constexpr unsigned char kJpeg[] = {0xff, 0xd8, 0xff};
  if (bytes.size() >= sizeof kPng && std::memcmp(bytes.data(), kPng, sizeof kPng) == 0) {
    return decode_png(bytes, where);
  }
  if (bytes.size() >= sizeof kJpeg && std::memcmp(bytes.data(), kJpeg, sizeof kJpeg) == 0) {
    return decode_jpeg(bytes, where);
  }
  throw InputError(where, "neither PNG nor JPEG", kAdvice);
}

}  // namespace sextant
