// SPDX-License-Identifier: Apache-2.0
#include "runtime/search/reference/thesis_tables.h"

#include <algorithm>
#include <cmath>

namespace sextant {
namespace {

/// 2-D sums of is_set(x, y), (width + 1) x (height + 1), written to out.
template <typename IsSet>
void accumulate(int width, int height, IsSet is_set, std::int32_t* out) {
  const int w = width + 1;
  std::fill(out, out + w, 0);
  for (int y = 0; y < height; ++y) {
    std::int32_t row = 0;
    std::int32_t* below = out + static_cast<std::ptrdiff_t>(y + 1) * w;
    const std::int32_t* above = below - w;
    below[0] = 0;
    for (int x = 0; x < width; ++x) {
      row += is_set(x, y) ? 1 : 0;
      below[x + 1] = above[x + 1] + row;
    }
  }
}

}  // namespace

ThesisTables::ThesisTables(const FrameTables& tables)
    : tables_(tables), width_(tables.width()), height_(tables.height()), slabs_(0) {
  const auto at = [&](int x, int y) { return (y + 1) * tables.stride() + x + 1; };
  const auto plane = static_cast<std::size_t>(width_ + 1) * static_cast<std::size_t>(height_ + 1);
  for (int k = 0; k < 8; ++k) {
    Sums& sums = features_[static_cast<std::size_t>(k)];
    sums.resize(plane);
    const std::uint16_t* distance = tables.distance2(k, 0);
    accumulate(
        width_, height_, [&](int x, int y) { return distance[at(x, y)] == 0; }, sums.data());
  }
  const std::uint16_t* depth = tables.nearest_depth(0);
  missing_.resize(plane);
  accumulate(
      width_, height_, [&](int x, int y) { return depth[at(x, y)] == FrameTables::kMissing; },
      missing_.data());
  slabs_ = static_cast<int>(FrameTables::kLargestDepth * FrameTables::kDepthUnit / kSlab) + 1;
  depths_.resize(plane * static_cast<std::size_t>(slabs_));
  for (int s = 0; s < slabs_; ++s) {
    accumulate(
        width_, height_,
        [&](int x, int y) {
          const std::uint16_t d = depth[at(x, y)];
          return d != FrameTables::kMissing &&
                 static_cast<int>(std::floor(static_cast<float>(d) * FrameTables::kDepthUnit / kSlab)) <= s;
        },
        depths_.data() + plane * static_cast<std::size_t>(s));
  }
}

std::int64_t ThesisTables::sum(const Sums& sums, std::size_t offset, const PixelRect& r) const {
  const int x0 = std::clamp(r.x0, 0, width_);
  const int x1 = std::clamp(r.x1 + 1, 0, width_);
  const int y0 = std::clamp(r.y0, 0, height_);
  const int y1 = std::clamp(r.y1 + 1, 0, height_);
  if (x0 >= x1 || y0 >= y1) return 0;
  const auto at = [&](int x, int y) {
    return static_cast<std::int64_t>(
        sums[offset + static_cast<std::size_t>(y) * static_cast<std::size_t>(width_ + 1) +
             static_cast<std::size_t>(x)]);
  };
  return at(x1, y1) - at(x0, y1) - at(x1, y0) + at(x0, y0);
}

std::int64_t ThesisTables::features(int kind, const PixelRect& r) const {
  return sum(features_[static_cast<std::size_t>(kind)], 0, r);
}

std::int64_t ThesisTables::missing(const PixelRect& r) const { return sum(missing_, 0, r); }

std::int64_t ThesisTables::depths(const PixelRect& r, float z0, float z1) const {
  const auto plane = static_cast<std::size_t>(width_ + 1) * static_cast<std::size_t>(height_ + 1);
  const int last = std::clamp(static_cast<int>(std::floor(z1 / kSlab)), -1, slabs_ - 1);
  const int before = std::clamp(static_cast<int>(std::floor(z0 / kSlab)) - 1, -1, slabs_ - 1);
  const auto up_to = [&](int slab) {
    return slab < 0 ? 0 : sum(depths_, plane * static_cast<std::size_t>(slab), r);
  };
  return up_to(last) - up_to(before);
}

}  // namespace sextant
