// SPDX-License-Identifier: Apache-2.0
#include "runtime/frame/colour_remap.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace sextant {
namespace {

constexpr int kOne = 64;  ///< steps of a pixel
/// Three channels lie in one 64-bit word, 21 bits each: 255 * 64 * 64 and a half need 20.
constexpr int kLane = 21;
constexpr std::uint64_t kHalf = std::uint64_t{kOne} * kOne / 2;
constexpr std::uint64_t kHalves = kHalf | kHalf << kLane | kHalf << (2 * kLane);
constexpr int kShift = 12;  ///< log2(64 * 64)

/// Red, green and blue (the three low bytes, in the memory's order) to lanes.
inline std::uint64_t in_lanes(std::uint64_t rgb) {
  return (rgb & 0xff) | (rgb & 0xff00) << (kLane - 8) | (rgb & 0xff0000) << (2 * kLane - 16);
}

inline std::uint64_t load(const std::uint8_t* bytes) {
  std::uint32_t word = 0;
  std::memcpy(&word, bytes, sizeof word);
  return word;
}

/// Two neighbours of one row. The right one is read from a byte before it, so that nothing behind it is read.
inline std::uint64_t blended(const std::uint8_t* left, std::uint64_t right_share) {
  return in_lanes(load(left)) * (kOne - right_share) + in_lanes(load(left + 2) >> 8) * right_share;
}

struct Split {
  int whole;
  int part;
};

/// A coordinate as the left (upper) of two neighbours and a share of the right (lower) one.
Split split(float coordinate, int size) {
  // Written so that a NaN becomes 0.
  const float inside = coordinate > 0 ? std::min(coordinate, static_cast<float>(size - 1)) : 0.0F;
  const int steps = static_cast<int>(std::lround(inside * kOne));
  const int whole = std::min(steps / kOne, size - 2);
  return {whole, steps - whole * kOne};
}

}  // namespace

ColourRemap::ColourRemap(const cv::Mat& source_pixels, cv::Size source)
    : source_(source), size_(source_pixels.size()) {
  CV_Assert(source_pixels.type() == CV_32FC2 && source.width >= 2 && source.height >= 2 &&
            source.width <= 16384 && source.height <= 16384);
  places_.reserve(source_pixels.total());
  for (int y = 0; y < source_pixels.rows; ++y) {
    const auto* row = source_pixels.ptr<cv::Vec2f>(y);
    for (int x = 0; x < source_pixels.cols; ++x) {
      const Split across = split(row[x][0], source.width);
      const Split along = split(row[x][1], source.height);
      places_.push_back({static_cast<std::uint16_t>(along.whole),
                         static_cast<std::uint16_t>(3 * across.whole), static_cast<std::uint8_t>(across.part),
                         static_cast<std::uint8_t>(along.part)});
    }
  }
}

cv::Mat ColourRemap::operator()(const cv::Mat& image) const {
  CV_Assert(image.type() == CV_8UC3 && image.size() == source_);
  cv::Mat out(size_, CV_8UC3);
  const std::size_t step = image.step;
  const std::uint8_t* pixels = image.data;
  const Place* place = places_.data();
  for (int y = 0; y < out.rows; ++y) {
    auto* target = out.ptr<std::uint8_t>(y);
    for (int x = 0; x < out.cols; ++x, ++place, target += 3) {
      const std::uint8_t* upper = pixels + place->row * step + place->offset;
      const std::uint64_t down = place->down;
      const std::uint64_t sum =
          blended(upper, place->right) * (kOne - down) + blended(upper + step, place->right) * down + kHalves;
      target[0] = static_cast<std::uint8_t>(sum >> kShift);
      target[1] = static_cast<std::uint8_t>(sum >> (kShift + kLane));
      target[2] = static_cast<std::uint8_t>(sum >> (kShift + 2 * kLane));
    }
  }
  return out;
}

}  // namespace sextant
