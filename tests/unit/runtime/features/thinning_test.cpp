// SPDX-License-Identifier: Apache-2.0
#include "runtime/features/thinning.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "every_target.h"

namespace sextant {
namespace {

/// Discs, boxes and lines on noise: ridges in all directions, some of equal neighbours.
cv::Mat scene(const cv::Size& size, std::uint64_t seed) {
  cv::RNG random(seed);
  cv::Mat image(size, CV_8UC3);
  random.fill(image, cv::RNG::NORMAL, 90, 4);
  const auto point = [&] { return cv::Point(random.uniform(0, size.width), random.uniform(0, size.height)); };
  const auto colour = [&] {
    return cv::Scalar(random.uniform(0, 256), random.uniform(0, 256), random.uniform(0, 256));
  };
  for (int i = 0; i < 12; ++i) {
    cv::circle(image, point(), random.uniform(3, 40), colour(), cv::FILLED);
    cv::rectangle(image, point(), point(), colour(), random.uniform(1, 4));
    cv::line(image, point(), point(), colour(), random.uniform(1, 6), cv::LINE_AA);
  }
  return image;
}

TEST(Thinning, IsCannyOnEveryTarget) {
  on_every_target([] {
    Thinning thinning;
    int found = 0;
    for (const cv::Size size : {cv::Size(640, 480), cv::Size(1, 1), cv::Size(1, 30), cv::Size(30, 1),
                                cv::Size(17, 9), cv::Size(133, 71)}) {
      const Gradient gradient = strongest_gradient_plain(scene(size, static_cast<std::uint64_t>(size.width)));
      for (const auto& [low, high] :
           {std::pair(60, 120), std::pair(15, 30), std::pair(1, 400), std::pair(90, 90)}) {
        cv::Mat ours;
        thinning.edges(gradient, low, high, ours);
        cv::Mat theirs;
        cv::Canny(gradient.dx, gradient.dy, theirs, low, high, true);
        ASSERT_EQ(ours.size(), theirs.size());
        EXPECT_EQ(cv::norm(ours, theirs, cv::NORM_INF), 0) << size << " " << low << " " << high;
        found += cv::countNonZero(ours);
      }
    }
    EXPECT_GT(found, 10000);
  });
}

}  // namespace
}  // namespace sextant
