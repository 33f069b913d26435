// SPDX-License-Identifier: Apache-2.0
#include "offline/learn/nearest_feature.h"

#include <cstdlib>

namespace sextant {
namespace {

/// Row of the nearest feature in each column, -1 where the column has none.
std::vector<std::int16_t> nearest_in_column(const cv::Mat& edges, unsigned bit) {
  const int w = edges.cols;
  const int h = edges.rows;
  std::vector<std::int16_t> row(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), -1);
  const auto at = [&](int y, int x) -> std::int16_t& {
    return row[static_cast<std::size_t>(y) * static_cast<std::size_t>(w) + static_cast<std::size_t>(x)];
  };
  for (int y = 0; y < h; ++y) {
    const auto* e = edges.ptr<std::uint8_t>(y);
    for (int x = 0; x < w; ++x)
      at(y, x) = (e[x] & bit) ? static_cast<std::int16_t>(y) : (y > 0 ? at(y - 1, x) : -1);
  }
  for (int y = h - 2; y >= 0; --y) {
    for (int x = 0; x < w; ++x) {
      const std::int16_t below = at(y + 1, x);
      if (below >= 0 && (at(y, x) < 0 || below - y < y - at(y, x))) at(y, x) = below;
    }
  }
  return row;
}

}  // namespace

std::vector<NearestFeature> nearest_features(const cv::Mat& edges, int kind,
                                             const std::vector<bool>& wanted) {
  const int w = edges.cols;
  const int h = edges.rows;
  const std::vector<std::int16_t> column_row = nearest_in_column(edges, 1U << static_cast<unsigned>(kind));
  std::vector<NearestFeature> out(static_cast<std::size_t>(w) * static_cast<std::size_t>(h));
  // Lower envelope of parabolas, one per column that has a feature.
  std::vector<int> apex(static_cast<std::size_t>(w));
  std::vector<double> from(static_cast<std::size_t>(w) + 1);
  for (int y = 0; y < h; ++y) {
    if (!wanted.empty() && !wanted[static_cast<std::size_t>(y)]) continue;
    const std::int16_t* rows = column_row.data() + static_cast<std::ptrdiff_t>(y) * w;
    const auto height = [&](int x) { return static_cast<double>((rows[x] - y) * (rows[x] - y)); };
    int count = 0;
    for (int x = 0; x < w; ++x) {
      if (rows[x] < 0) continue;
      double cut = -1e30;
      while (count > 0) {
        const int q = apex[static_cast<std::size_t>(count - 1)];
        cut = (height(x) + x * x - height(q) - q * q) / (2.0 * (x - q));
        if (cut > from[static_cast<std::size_t>(count - 1)]) break;
        --count;
        cut = -1e30;
      }
      apex[static_cast<std::size_t>(count)] = x;
      from[static_cast<std::size_t>(count)] = cut;
      ++count;
    }
    if (count == 0) continue;
    int k = 0;
    for (int x = 0; x < w; ++x) {
      while (k + 1 < count && from[static_cast<std::size_t>(k + 1)] < x) ++k;
      const int q = apex[static_cast<std::size_t>(k)];
      out[static_cast<std::size_t>(y) * static_cast<std::size_t>(w) + static_cast<std::size_t>(x)] = {
          static_cast<std::int16_t>(q), rows[q]};
    }
  }
  return out;
}

}  // namespace sextant
