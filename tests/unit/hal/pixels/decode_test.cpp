// SPDX-License-Identifier: Apache-2.0
// Colour decoding against conversions written down here from the standard (BT.601), pixel by pixel.
#include "hal/pixels/decode.h"

#include <gmock/gmock.h>
#include <turbojpeg.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "runtime/base/error.h"

namespace sextant {
namespace {

constexpr int kWidth = 66;  // no multiple of a vector register
constexpr int kHeight = 34;

std::vector<std::byte> noise(std::size_t size) {
  std::mt19937 random(5);
  std::vector<std::byte> bytes(size);
  for (std::byte& b : bytes) b = static_cast<std::byte>(random() % 256);
  return bytes;
}

RawImage raw(PixelFormat format, const std::vector<std::byte>& bytes, std::size_t stride) {
  RawImage image;
  image.format = format;
  image.width = kWidth;
  image.height = kHeight;
  image.stride = stride;
  image.bytes = bytes;
  return image;
}

/// BT.601, luma 16..235, chroma 16..240. Luma below black is black (the noise has such, cameras have not).
cv::Vec3i rgb_of(std::byte y8, std::byte u8, std::byte v8) {
  const double y = std::max(0, std::to_integer<int>(y8) - 16) * 255.0 / 219;
  const double u = (std::to_integer<int>(u8) - 128) * 255.0 / 224;
  const double v = (std::to_integer<int>(v8) - 128) * 255.0 / 224;
  const auto clamp = [](double c) { return static_cast<int>(std::lround(std::clamp(c, 0.0, 255.0))); };
  return {clamp(y + 1.402 * v), clamp(y - 0.344136 * u - 0.714136 * v), clamp(y + 1.772 * u)};
}

template <typename Expected>
void expect_image(const RawImage& image, Expected expected, int tolerance) {
  const cv::Mat rgb = decode_colour(image, "test");
  ASSERT_EQ(rgb.type(), CV_8UC3);
  ASSERT_EQ(rgb.size(), cv::Size(kWidth, kHeight));
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const cv::Vec3i wanted = expected(x, y);
      const auto got = rgb.at<cv::Vec3b>(y, x);
      for (int c = 0; c < 3; ++c) ASSERT_NEAR(got[c], wanted[c], tolerance) << x << " " << y << " " << c;
    }
  }
}

TEST(DecodeColour, Yuyv) {
  const std::size_t stride = kWidth * 2 + 12;
  const auto bytes = noise(stride * kHeight);
  expect_image(
      raw(PixelFormat::kYuyv, bytes, stride),
      [&](int x, int y) {
        const std::byte* pair =
            &bytes[static_cast<std::size_t>(y) * stride + static_cast<std::size_t>(x / 2) * 4];
        return rgb_of(pair[x % 2 * 2], pair[1], pair[3]);
      },
      2);
}

TEST(DecodeColour, Uyvy) {
  const std::size_t stride = kWidth * 2;
  const auto bytes = noise(stride * kHeight);
  expect_image(
      raw(PixelFormat::kUyvy, bytes, stride),
      [&](int x, int y) {
        const std::byte* pair =
            &bytes[static_cast<std::size_t>(y) * stride + static_cast<std::size_t>(x / 2) * 4];
        return rgb_of(pair[1 + x % 2 * 2], pair[0], pair[2]);
      },
      2);
}

TEST(DecodeColour, Nv12) {
  const std::size_t stride = kWidth + 14;
  const auto bytes = noise(stride * kHeight * 3 / 2);
  expect_image(
      raw(PixelFormat::kNv12, bytes, stride),
      [&](int x, int y) {
        const std::byte luma = bytes[static_cast<std::size_t>(y) * stride + static_cast<std::size_t>(x)];
        const std::byte* chroma =
            &bytes[static_cast<std::size_t>(kHeight + y / 2) * stride + static_cast<std::size_t>(x / 2) * 2];
        return rgb_of(luma, chroma[0], chroma[1]);
      },
      2);
}

TEST(DecodeColour, RgbBgrAndGreyAreExact) {
  for (const bool bgr : {false, true}) {
    const std::size_t stride = kWidth * 3 + 2;
    const auto bytes = noise(stride * kHeight);
    expect_image(
        raw(bgr ? PixelFormat::kBgr24 : PixelFormat::kRgb24, bytes, stride),
        [&](int x, int y) {
          const std::byte* p = &bytes[static_cast<std::size_t>(y) * stride + static_cast<std::size_t>(x) * 3];
          return cv::Vec3i(std::to_integer<int>(p[bgr ? 2 : 0]), std::to_integer<int>(p[1]),
                           std::to_integer<int>(p[bgr ? 0 : 2]));
        },
        0);
  }
  const auto bytes = noise(kWidth * kHeight);
  expect_image(
      raw(PixelFormat::kGrey, bytes, kWidth),
      [&](int x, int y) {
        const int v = std::to_integer<int>(bytes[static_cast<std::size_t>(y * kWidth + x)]);
        return cv::Vec3i(v, v, v);
      },
      0);
}

class Mjpeg : public testing::Test {
 protected:
  Mjpeg() {
    picture_ = cv::Mat(kHeight, kWidth, CV_8UC3);
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x)
        picture_.at<cv::Vec3b>(y, x) = cv::Vec3b(static_cast<uchar>(3 * x), static_cast<uchar>(5 * y), 90);
    tjhandle handle = tjInitCompress();
    unsigned char* out = nullptr;
    unsigned long size = 0;
    tjCompress2(handle, picture_.data, kWidth, 0, kHeight, TJPF_RGB, &out, &size, TJSAMP_422, 95, 0);
    const auto* begin = reinterpret_cast<const std::byte*>(out);
    bytes_.assign(begin, begin + size);
    tjFree(out);
    tjDestroy(handle);
  }
  cv::Mat picture_;
  std::vector<std::byte> bytes_;
};

TEST_F(Mjpeg, DecodesThePicture) {
  expect_image(
      raw(PixelFormat::kMjpeg, bytes_, 0),
      [&](int x, int y) { return cv::Vec3i(picture_.at<cv::Vec3b>(y, x)); }, 14);
}

TEST_F(Mjpeg, ToleratesStrayBytesBeforeTheEnd) {
  bytes_.insert(bytes_.end() - 2, 3, std::byte{0x11});
  EXPECT_NO_THROW(decode_colour(raw(PixelFormat::kMjpeg, bytes_, 0), "test"));
}

TEST_F(Mjpeg, RefusesWhatIsCutOrDamagedOrOfAnotherSize) {
  for (std::size_t size = 0; size < bytes_.size() - 2; size += 37) {
    const std::vector<std::byte> cut(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_THROW(decode_colour(raw(PixelFormat::kMjpeg, cut, 0), "test"), InputError) << size;
  }
  RawImage other = raw(PixelFormat::kMjpeg, bytes_, 0);
  other.width += 2;
  EXPECT_THROW(decode_colour(other, "test"), InputError);
  std::mt19937 random(9);
  int refused = 0;
  for (int round = 0; round < 200; ++round) {
    auto damaged = bytes_;
    for (int i = 0; i < 4; ++i) damaged[random() % damaged.size()] = static_cast<std::byte>(random());
    try {
      decode_colour(raw(PixelFormat::kMjpeg, damaged, 0), "test");
    } catch (const InputError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 50);
}

TEST(DecodeColour, RefusesWhatDoesNotFit) {
  const auto bytes = noise(kWidth * 2 * kHeight);
  const auto throws = [](const RawImage& image) { EXPECT_THROW(decode_colour(image, "test"), InputError); };
  throws(raw(PixelFormat::kYuyv, bytes, kWidth * 2 - 1));
  throws(raw(PixelFormat::kYuyv, bytes, kWidth * 2 + 2));
  throws(raw(PixelFormat::kYuyv, bytes, std::size_t{1} << 62));
  throws(raw(PixelFormat::kZ16, bytes, kWidth * 2));
  RawImage image = raw(PixelFormat::kGrey, bytes, kWidth);
  image.width = 0;
  throws(image);
  image.width = -5;
  throws(image);
  image = raw(PixelFormat::kYuyv, bytes, kWidth * 2);
  image.width = 65;  // half a pair
  throws(image);
  image = raw(PixelFormat::kGrey, bytes, kWidth);
  image.height = 1 << 20;
  throws(image);
}

}  // namespace
}  // namespace sextant
