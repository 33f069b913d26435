// SPDX-License-Identifier: Apache-2.0
#include "offline/synthesize/noise_field.h"

#include <cmath>
#include <opencv2/imgproc.hpp>

namespace sextant {
namespace {

constexpr double kCoarseSigma = 4;  ///< pixels of the coarse field: finer ones are enlarged without loss

}  // namespace

cv::Mat white_noise(const cv::Size& size, Random& random) {
  const double scale = std::sqrt(3.0);
  cv::Mat noise(size, CV_32FC1);
  for (int y = 0; y < noise.rows; ++y) {
    for (int x = 0; x < noise.cols; ++x) {
      const std::uint64_t bits = random.bits();
      std::uint64_t sum = 0;
      for (int part = 0; part < 4; ++part) sum += (bits >> (16 * part)) & 0xFFFF;
      noise.at<float>(y, x) = static_cast<float>(scale * (static_cast<double>(sum) / 65535.0 - 2));
    }
  }
  return noise;
}

cv::Mat smooth_noise(const cv::Size& size, double sigma_px, Random& random) {
  const double shrink = std::max(1.0, sigma_px / kCoarseSigma);
  const double sigma = sigma_px / shrink;
  const int radius = static_cast<int>(std::ceil(4 * sigma));
  const cv::Size inner(static_cast<int>(std::ceil(size.width / shrink)) + 2,
                       static_cast<int>(std::ceil(size.height / shrink)) + 2);
  const cv::Mat noise = white_noise({inner.width + 2 * radius, inner.height + 2 * radius}, random);
  const cv::Mat kernel = cv::getGaussianKernel(2 * radius + 1, sigma, CV_32F);
  cv::Mat blurred;
  cv::sepFilter2D(noise, blurred, CV_32F, kernel, kernel);
  // Variance of a sum of independent pixels: the squared weights.
  blurred *= 1.0 / kernel.dot(kernel);
  const cv::Mat field = blurred(cv::Rect(radius, radius, inner.width, inner.height));
  if (shrink == 1.0) return field(cv::Rect(cv::Point(0, 0), size)).clone();
  const cv::Matx23f coarse_from_fine(static_cast<float>(1 / shrink), 0, 1, 0, static_cast<float>(1 / shrink),
                                     1);
  cv::Mat result;
  cv::warpAffine(field, result, coarse_from_fine, size, cv::INTER_CUBIC | cv::WARP_INVERSE_MAP,
                 cv::BORDER_REPLICATE);
  return result;
}

}  // namespace sextant
