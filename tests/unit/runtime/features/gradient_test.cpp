// SPDX-License-Identifier: Apache-2.0
#include "runtime/features/gradient.h"

#include <gtest/gtest.h>

#include "every_target.h"

namespace sextant {
namespace {

bool equal(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
}

/// Noise of full range, so that gradients are long, in blocks, so that many channels are equal.
cv::Mat noise(const cv::Size& size, std::uint64_t seed) {
  cv::RNG random(seed);
  cv::Mat image(size, CV_8UC3);
  random.fill(image, cv::RNG::UNIFORM, 0, 256);
  for (int i = 0; i < 8; ++i) {
    const cv::Rect box(random.uniform(0, size.width), random.uniform(0, size.height), size.width / 3 + 1,
                       size.height / 3 + 1);
    const double grey = random.uniform(0, 2) * 255.0;
    image(box & cv::Rect({0, 0}, size)).setTo(cv::Scalar::all(grey));
  }
  return image;
}

TEST(Gradient, IsThePlainOneOnEveryTarget) {
  on_every_target([] {
    Gradient fast;
    for (const cv::Size size : {cv::Size(640, 480), cv::Size(1, 1), cv::Size(1, 9), cv::Size(9, 1),
                                cv::Size(2, 2), cv::Size(63, 5), cv::Size(131, 77), cv::Size(257, 3)}) {
      const cv::Mat image = noise(size, static_cast<std::uint64_t>(size.area()));
      strongest_gradient(image, fast);
      const Gradient plain = strongest_gradient_plain(image);
      EXPECT_TRUE(equal(fast.dx, plain.dx)) << size;
      EXPECT_TRUE(equal(fast.dy, plain.dy)) << size;
    }
  });
}

TEST(Gradient, OfAViewIntoALargerImageIsThatOfItsCopy) {
  const cv::Mat whole = noise({200, 100}, 3);
  const cv::Mat part = whole(cv::Rect(17, 9, 101, 55));
  Gradient of_view;
  Gradient of_copy;
  strongest_gradient(part, of_view);
  strongest_gradient(part.clone(), of_copy);
  EXPECT_TRUE(equal(of_view.dx, of_copy.dx));
  EXPECT_TRUE(equal(of_view.dy, of_copy.dy));
}

}  // namespace
}  // namespace sextant
