// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "hal/image/image_file.h"
#include "hal/pixels/decode.h"
#include "runtime/base/error.h"

namespace sextant {

void check_layout(const RawImage& image, const std::string& where) {
  const char* name = info_of(image.format).name;
  if (image.width < 1 || image.height < 1 || image.width > kMaxImageSide || image.height > kMaxImageSide) {
    throw InputError(where, fmt::format("a {} image of {} x {} pixels", name, image.width, image.height),
                     fmt::format("sides must be 1 to {}", kMaxImageSide));
  }
  if (image.format == PixelFormat::kMjpeg) {
    if (image.bytes.empty()) throw InputError(where, "an empty JPEG", "");
    return;
  }
  const std::size_t least = least_stride(image.format, image.width);
  if (image.stride < least || image.stride > least + (std::size_t{1} << 20)) {
    throw InputError(where, fmt::format("a {} line of {} pixels has {} bytes, needs {}", name, image.width,
                                        image.stride, least));
  }
  const std::size_t needed = image_bytes(image.format, image.width, image.height, image.stride);
  if (image.bytes.size() < needed) {
    throw InputError(where, fmt::format("a {} image of {} x {} pixels has {} bytes, needs {}", name,
                                        image.width, image.height, image.bytes.size(), needed));
  }
}

}  // namespace sextant
