// SPDX-License-Identifier: Apache-2.0
// How depth noise on a table is measured: residual to the known plane, split into a slow part (box mean over
// 31 pixels of the valid ones) and the fast rest; spreads per depth, correlation of the fast part at 1 and 4
// pixels along rows. The same measurement runs on real frames and on the sensor model.
#pragma once

#include <cmath>
#include <map>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace sextant {

struct NoiseStatistics {
  struct Row {
    int pixels = 0;
    double fast_mm = 0;  ///< rms of the fast part
    double slow_mm = 0;  ///< rms of the slow part
  };
  std::map<int, Row> by_depth;  ///< key: depth in units of 0.1 m, rounded down
  double correlation_1 = 0;     ///< of the fast part at a distance of 1 pixel
  double correlation_4 = 0;     ///< at 4 pixels
};

/// residual_mm: CV_32FC1; mask: CV_8UC1, 255 where the residual is to be used; depth_m: CV_32FC1.
inline NoiseStatistics measure_noise(const cv::Mat& residual_mm, const cv::Mat& mask, const cv::Mat& depth_m,
                                     int window = 31) {
  cv::Mat valid;
  mask.convertTo(valid, CV_32FC1, 1.0 / 255);
  cv::Mat sum;
  cv::Mat weight;
  cv::boxFilter(residual_mm.mul(valid), sum, CV_32F, {window, window}, {-1, -1}, false, cv::BORDER_CONSTANT);
  cv::boxFilter(valid, weight, CV_32F, {window, window}, {-1, -1}, false, cv::BORDER_CONSTANT);
  NoiseStatistics result;
  std::map<int, std::array<double, 2>> squares;
  double c0 = 0, c1 = 0, c4 = 0, n0 = 0, n1 = 0, n4 = 0;
  cv::Mat fast(residual_mm.size(), CV_32FC1, cv::Scalar(0));
  cv::Mat used(residual_mm.size(), CV_8UC1, cv::Scalar(0));
  for (int y = 0; y < mask.rows; ++y) {
    for (int x = 0; x < mask.cols; ++x) {
      // Windows that are mostly on the table only.
      if (!mask.at<unsigned char>(y, x) ||
          weight.at<float>(y, x) < 0.8F * static_cast<float>(window * window))
        continue;
      const float slow = sum.at<float>(y, x) / weight.at<float>(y, x);
      const float rest = residual_mm.at<float>(y, x) - slow;
      fast.at<float>(y, x) = rest;
      used.at<unsigned char>(y, x) = 255;
      const int key = static_cast<int>(depth_m.at<float>(y, x) * 10);
      ++result.by_depth[key].pixels;
      squares[key][0] += rest * rest;
      squares[key][1] += slow * slow;
    }
  }
  for (auto& [key, row] : result.by_depth) {
    row.fast_mm = std::sqrt(squares[key][0] / row.pixels);
    row.slow_mm = std::sqrt(squares[key][1] / row.pixels);
  }
  for (int y = 0; y < mask.rows; ++y) {
    for (int x = 0; x < mask.cols; ++x) {
      if (!used.at<unsigned char>(y, x)) continue;
      // Weighted by the depth's own spread, so that far pixels do not decide alone.
      const double spread = result.by_depth[static_cast<int>(depth_m.at<float>(y, x) * 10)].fast_mm;
      const double v = fast.at<float>(y, x) / spread;
      const auto pair = [&](int d, double& c, double& n) {
        if (x + d >= mask.cols || !used.at<unsigned char>(y, x + d)) return;
        c += v * fast.at<float>(y, x + d) / spread;
        ++n;
      };
      pair(0, c0, n0);
      pair(1, c1, n1);
      pair(4, c4, n4);
    }
  }
  result.correlation_1 = (c1 / n1) / (c0 / n0);
  result.correlation_4 = (c4 / n4) / (c0 / n0);
  return result;
}

}  // namespace sextant
