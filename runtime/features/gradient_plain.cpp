// SPDX-License-Identifier: Apache-2.0
#include <opencv2/imgproc.hpp>

#include "runtime/features/gradient.h"

namespace sextant {

Gradient strongest_gradient_plain(const cv::Mat& colour) {
  cv::Mat smooth;
  cv::GaussianBlur(colour, smooth, {3, 3}, 0, 0, cv::BORDER_REPLICATE);
  cv::Mat gx;
  cv::Mat gy;
  cv::Sobel(smooth, gx, CV_16S, 1, 0, 3, 1, 0, cv::BORDER_REPLICATE);
  cv::Sobel(smooth, gy, CV_16S, 0, 1, 3, 1, 0, cv::BORDER_REPLICATE);
  Gradient out{cv::Mat(colour.size(), CV_16SC1), cv::Mat(colour.size(), CV_16SC1)};
  for (int y = 0; y < colour.rows; ++y) {
    const auto* sx = gx.ptr<cv::Vec3s>(y);
    const auto* sy = gy.ptr<cv::Vec3s>(y);
    auto* tx = out.dx.ptr<short>(y);
    auto* ty = out.dy.ptr<short>(y);
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
  return out;
}

}  // namespace sextant
