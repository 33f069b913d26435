// SPDX-License-Identifier: Apache-2.0
// PNG through libspng. Limits are set before anything is decoded, and no buffer is allocated that a file of
// this size cannot fill (deflate expands at most about 1032 times).
#include <spng.h>

#include <cstdlib>
#include <memory>

#include "hal/image/image_file.h"
#include "runtime/base/error.h"

namespace sextant {
namespace {

constexpr std::size_t kMaxExpansion = 1100;  ///< of deflate, rounded up

constexpr std::size_t kMaxChunkBytes = std::size_t{16}
                                       << 20;  ///< of any chunk beside the pixels, and of all of them

struct ContextFree {
  void operator()(spng_ctx* context) const { spng_ctx_free(context); }
};
using Context = std::unique_ptr<spng_ctx, ContextFree>;

struct Free {
  void operator()(void* p) const { std::free(p); }
};

[[noreturn]] void refuse(const std::string& where, int error) {
  throw InputError(where, std::string("this PNG cannot be decoded: ") + spng_strerror(error),
                   "the file is damaged; get it again");
}

}  // namespace

cv::Mat decode_png(std::span<const std::byte> bytes, const std::string& where) {
  const Context context(spng_ctx_new(0));
  if (!context) throw InputError(where, "there is no memory to decode this PNG");
  int error = spng_set_image_limits(context.get(), kMaxImageSide, kMaxImageSide);
  if (!error) error = spng_set_chunk_limits(context.get(), kMaxChunkBytes, kMaxChunkBytes);
  if (!error) error = spng_set_png_buffer(context.get(), bytes.data(), bytes.size());
  spng_ihdr header{};
  if (!error) error = spng_get_ihdr(context.get(), &header);
  if (error == SPNG_EUSER_WIDTH || error == SPNG_EUSER_HEIGHT) {
    throw InputError(where, "has more than " + std::to_string(kMaxImageSide) + " pixels a side", "shrink it");
  }
  if (error) refuse(where, error);
  const std::size_t pixels = std::size_t{header.width} * header.height;
  if (pixels > kMaxImagePixels) {
    throw InputError(
        where, "has " + std::to_string(pixels) + " pixels, more than " + std::to_string(kMaxImagePixels),
        "shrink it");
  }
  const bool deep_grey = header.color_type == SPNG_COLOR_TYPE_GRAYSCALE && header.bit_depth == 16;
  const int format = deep_grey ? SPNG_FMT_PNG : SPNG_FMT_RGB8;
  std::size_t size = 0;
  error = spng_decoded_image_size(context.get(), format, &size);
  if (error) refuse(where, error);
  // Packed grey or palette pixels take 1 bit each in the file: the smallest that deflate can hold them in.
  if (pixels / 8 / kMaxExpansion > bytes.size()) refuse(where, SPNG_IO_EOF);
  cv::Mat image(static_cast<int>(header.height), static_cast<int>(header.width),
                deep_grey ? CV_16UC1 : CV_8UC3);
  if (size != image.total() * image.elemSize()) refuse(where, SPNG_EINTERNAL);
  error = spng_decode_image(context.get(), image.data, size, format, 0);
  if (error) refuse(where, error);
  return image;
}

std::vector<std::byte> encode_png(const cv::Mat& image, int compression) {
  const bool colour = image.type() == CV_8UC3;
  if ((!colour && image.type() != CV_16UC1) || image.empty() || image.cols > kMaxImageSide ||
      image.rows > kMaxImageSide) {
    throw std::invalid_argument("encode_png takes CV_8UC3 or CV_16UC1 of 1..16384 pixels a side");
  }
  const cv::Mat packed = image.isContinuous() ? image : image.clone();
  const Context context(spng_ctx_new(SPNG_CTX_ENCODER));
  if (!context) throw std::bad_alloc();
  spng_ihdr header{};
  header.width = static_cast<std::uint32_t>(packed.cols);
  header.height = static_cast<std::uint32_t>(packed.rows);
  header.bit_depth = colour ? 8 : 16;
  header.color_type = colour ? SPNG_COLOR_TYPE_TRUECOLOR : SPNG_COLOR_TYPE_GRAYSCALE;
  int error = spng_set_option(context.get(), SPNG_ENCODE_TO_BUFFER, 1);
  if (!error) error = spng_set_option(context.get(), SPNG_IMG_COMPRESSION_LEVEL, compression);
  // Choosing filters by line costs more than fast compression itself; one that suits images does as well.
  if (!error && compression <= 1) {
    error = spng_set_option(context.get(), SPNG_FILTER_CHOICE, SPNG_FILTER_CHOICE_SUB);
  }
  if (!error) error = spng_set_ihdr(context.get(), &header);
  if (!error) {
    error = spng_encode_image(context.get(), packed.data, packed.total() * packed.elemSize(), SPNG_FMT_PNG,
                              SPNG_ENCODE_FINALIZE);
  }
  std::size_t size = 0;
  std::unique_ptr<void, Free> buffer;
  if (!error) buffer.reset(spng_get_png_buffer(context.get(), &size, &error));
  if (error || !buffer) throw std::runtime_error(std::string("PNG encoding failed: ") + spng_strerror(error));
  const auto* first = static_cast<const std::byte*>(buffer.get());
  return {first, first + size};
}

}  // namespace sextant
