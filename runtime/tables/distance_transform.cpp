// SPDX-License-Identifier: Apache-2.0
#include "runtime/tables/distance_transform.h"

#include <algorithm>
#include <vector>

namespace sextant {
namespace {

constexpr std::uint16_t kFar = 65535;

/// Squared distance along the column, kFar beyond the clip radius; rows of `width` values.
void distances_along_columns(const cv::Mat& edges, unsigned bit, int clip, std::vector<std::uint16_t>& out) {
  const int width = edges.cols;
  const int height = edges.rows;
  const auto at = [&](int y) { return out.data() + static_cast<std::ptrdiff_t>(y) * width; };
  std::vector<std::uint16_t> steps(static_cast<std::size_t>(width));
  const auto far = static_cast<std::uint16_t>(clip + 1);
  const auto sweep = [&](int from, int to, int by) {
    std::fill(steps.begin(), steps.end(), far);
    for (int y = from; y != to; y += by) {
      const auto* row = edges.ptr<std::uint8_t>(y);
      std::uint16_t* o = at(y);
      for (int x = 0; x < width; ++x) {
        const auto next =
            static_cast<std::uint16_t>(std::min<int>(steps[static_cast<std::size_t>(x)] + 1, far));
        const auto s = (row[x] & bit) ? std::uint16_t{0} : next;
        steps[static_cast<std::size_t>(x)] = s;
        o[x] = std::min(o[x], s);
      }
    }
  };
  std::fill(out.begin(), out.end(), far);
  sweep(0, height, 1);
  sweep(height - 1, -1, -1);
  for (std::uint16_t& v : out) v = v > clip ? kFar : static_cast<std::uint16_t>(v * v);
}

}  // namespace

void clipped_distance2(const cv::Mat& edges, int kind, int clip_radius, std::uint16_t* out, int out_stride) {
  const int width = edges.cols;
  const int height = edges.rows;
  std::vector<std::uint16_t> column(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  distances_along_columns(edges, 1U << static_cast<unsigned>(kind), clip_radius, column);
  const auto limit = static_cast<std::uint16_t>(clip_radius * clip_radius);
  // min over dx of column[x + dx] + dx^2: plain loops over contiguous rows, which compilers vectorise.
  std::vector<std::uint16_t> padded(static_cast<std::size_t>(width + 2 * clip_radius), kFar);
  for (int y = 0; y < height; ++y) {
    const std::uint16_t* row = column.data() + static_cast<std::ptrdiff_t>(y) * width;
    std::uint16_t* o = out + static_cast<std::ptrdiff_t>(y) * out_stride;
    if (std::all_of(row, row + width, [](std::uint16_t v) { return v == kFar; })) {
      std::fill(o, o + width, kFar);
      continue;
    }
    std::copy(row, row + width, padded.begin() + clip_radius);
    std::copy(row, row + width, o);
    for (int d = 1; d <= clip_radius; ++d) {
      const auto d2 = static_cast<std::uint16_t>(d * d);
      const std::uint16_t* left = padded.data() + clip_radius - d;
      const std::uint16_t* right = padded.data() + clip_radius + d;
      for (int x = 0; x < width; ++x) {
        const std::uint16_t nearest = std::min(left[x], right[x]);
        const auto sum = static_cast<std::uint16_t>(nearest + d2);
        o[x] = std::min(o[x], sum < d2 ? kFar : sum);  // saturate
      }
    }
    for (int x = 0; x < width; ++x) o[x] = o[x] > limit ? kFar : o[x];
  }
}

}  // namespace sextant
