// SPDX-License-Identifier: Apache-2.0
#include "runtime/features/edges.h"

#include <cstdint>
#include <cstdlib>
#include <opencv2/imgproc.hpp>

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

cv::Mat edges_by_direction(const cv::Mat& colour, const EdgeOptions& options) {
  cv::Mat smooth;
  cv::GaussianBlur(colour, smooth, {3, 3}, 0, 0, cv::BORDER_REPLICATE);
  cv::Mat gx;
  cv::Mat gy;
  cv::Sobel(smooth, gx, CV_16S, 1, 0, 3, 1, 0, cv::BORDER_REPLICATE);
  cv::Sobel(smooth, gy, CV_16S, 0, 1, 3, 1, 0, cv::BORDER_REPLICATE);
  cv::Mat dx(colour.size(), CV_16SC1);
  cv::Mat dy(colour.size(), CV_16SC1);
  for (int y = 0; y < colour.rows; ++y) {
    const auto* sx = gx.ptr<cv::Vec3s>(y);
    const auto* sy = gy.ptr<cv::Vec3s>(y);
    auto* tx = dx.ptr<short>(y);
    auto* ty = dy.ptr<short>(y);
    for (int x = 0; x < colour.cols; ++x) {
      int best = -1;
      for (int c = 0; c < 3; ++c) {
        const int norm = sx[x][c] * sx[x][c] + sy[x][c] * sy[x][c];
        if (norm > best) {
          best = norm;
          tx[x] = sx[x][c];
          ty[x] = sy[x][c];
        }
      }
    }
  }
  cv::Mat edges;
  cv::Canny(dx, dy, edges, options.low, options.high, true);
  for (int y = 0; y < edges.rows; ++y) {
    auto* row = edges.ptr<std::uint8_t>(y);
    const auto* tx = dx.ptr<short>(y);
    const auto* ty = dy.ptr<short>(y);
    for (int x = 0; x < edges.cols; ++x) {
      if (row[x]) row[x] = static_cast<std::uint8_t>(edge_kinds(tx[x], ty[x]));
    }
  }
  return edges;
}

}  // namespace sextant
