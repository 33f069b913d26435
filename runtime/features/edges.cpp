// SPDX-License-Identifier: Apache-2.0
#include "runtime/features/edges.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <vector>

namespace sextant {

unsigned edge_kinds(int dx, int dy) {
  // The line is perpendicular to the gradient: direction (-dy, dx), folded to 0 <= angle < 180 deg.
  std::int64_t lx = -dy;
  std::int64_t ly = dx;
  if (ly < 0 || (ly == 0 && lx < 0)) {
    lx = -lx;
    ly = -ly;
  }
  // tan of 22.5, 45, 67.5 deg, times 2^15: how many kinds' centres the angle to the x axis has passed.
  constexpr std::int64_t kTangents[3] = {13573, 32768, 79109};
  const std::int64_t ax = std::abs(lx);
  unsigned passed = 0;
  while (passed < 3 && ly * 32768 >= kTangents[passed] * ax) ++passed;
  const unsigned below = lx >= 0 ? passed : 7 - passed;
  return (1U << below) | (1U << ((below + 1) % 8));
}

namespace {

/// The norm that `permille` of the pixels exceed, asked at every other pixel of every other row. (Floats
/// round the root of none of these integers up to the next one.)
int norm_exceeded_by(const cv::Mat& dx, const cv::Mat& dy, int permille) {
  constexpr int kLargest = 1 << 11;
  std::vector<int> histogram(kLargest + 1, 0);
  std::int64_t asked = 0;
  for (int y = 0; y < dx.rows; y += 2) {
    const auto* tx = dx.ptr<short>(y);
    const auto* ty = dy.ptr<short>(y);
    for (int x = 0; x < dx.cols; x += 2, ++asked) {
      const int norm = static_cast<int>(std::sqrt(static_cast<float>(tx[x] * tx[x] + ty[x] * ty[x])));
      ++histogram[static_cast<std::size_t>(std::min(norm, kLargest))];
    }
  }
  std::int64_t left = asked * permille / 1000;
  int norm = kLargest;
  while (norm > 0 && (left -= histogram[static_cast<std::size_t>(norm)]) >= 0) --norm;
  return norm;
}

EdgeOptions adapted(const EdgeOptions& options, const cv::Mat& dx, const cv::Mat& dy) {
  if (options.adapt_permille <= 0) return options;
  EdgeOptions out = options;
  const int least = std::min(options.adapt_least, options.high);
  out.high = std::clamp(norm_exceeded_by(dx, dy, options.adapt_permille), least, options.high);
  out.low = std::max(1, options.low * out.high / options.high);
  return out;
}

}  // namespace

cv::Mat EdgeFinder::edges_by_direction(const cv::Mat& colour, const EdgeOptions& options) {
  strongest_gradient(colour, gradient_);
  const EdgeOptions used = adapted(options, gradient_.dx, gradient_.dy);
  cv::Mat edges;
  thinning_.edges(gradient_, used.low, used.high, edges);
  for (int y = 0; y < edges.rows; ++y) {
    auto* row = edges.ptr<std::uint8_t>(y);
    const auto* dx = gradient_.dx.ptr<short>(y);
    const auto* dy = gradient_.dy.ptr<short>(y);
    for (int x = 0; x < edges.cols; ++x) {
      if (row[x]) row[x] = static_cast<std::uint8_t>(edge_kinds(dx[x], dy[x]));
    }
  }
  return edges;
}

cv::Mat edges_by_direction(const cv::Mat& colour, const EdgeOptions& options) {
  return EdgeFinder().edges_by_direction(colour, options);
}

}  // namespace sextant
