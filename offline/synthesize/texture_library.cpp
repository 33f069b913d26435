// SPDX-License-Identifier: Apache-2.0
#include "offline/synthesize/texture_library.h"

#include "offline/synthesize/textures.h"

namespace sextant {
namespace {

const cv::Size kLarge(1024, 1024);
const cv::Size kMiddle(512, 512);
const cv::Size kSmall(256, 256);

cv::Mat paint(TextureKind kind, Random& random) {
  switch (kind) {
    case TextureKind::kTable:
      return table_texture(kLarge, random);
    case TextureKind::kFloor:
      return floor_texture(kMiddle, random);
    case TextureKind::kWall:
      return wall_texture(kMiddle, random);
    case TextureKind::kPage:
      return page_texture(kMiddle, random);
    case TextureKind::kPrint:
      break;
  }
  return print_texture(kSmall, random);
}

}  // namespace

cv::Mat TextureLibrary::painted(TextureKind kind, int number) {
  const std::lock_guard lock(mutex_);
  cv::Mat& piece = stock_[{kind, number}];
  if (piece.empty()) {
    const auto stream = static_cast<std::uint64_t>(kind) * 1000 + static_cast<std::uint64_t>(number);
    Random random(derived_seed(seed_ ^ 0x7E87UL, stream));
    piece = paint(kind, random);
  }
  return piece;
}

cv::Mat TextureLibrary::pick(TextureKind kind, Random& random) {
  // Small prints are cheap and decide what clutter looks like: there are ten times as many.
  const int stock = kind == TextureKind::kPrint ? 10 * kStock : kStock;
  cv::Mat piece = painted(kind, random.integer(0, stock - 1));
  if (kind == TextureKind::kPrint || kind == TextureKind::kPage) return piece;
  const int side = static_cast<int>(piece.cols * random.uniform(0.6, 1));
  const int x = random.integer(0, piece.cols - side);
  const int y = random.integer(0, piece.rows - side);
  piece = piece(cv::Rect(x, y, side, side)).clone();
  if (random.chance(0.5)) cv::flip(piece, piece, 1);
  if (random.chance(0.5)) cv::transpose(piece, piece);
  return piece;
}

}  // namespace sextant
