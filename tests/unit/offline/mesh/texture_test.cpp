// SPDX-License-Identifier: Apache-2.0
#include "offline/mesh/texture.h"

#include <gmock/gmock.h>
#include <turbojpeg.h>

#include <cstring>
#include <random>

#include "offline/mesh/bundled/writers.h"
#include "tests/unit/offline/mesh/test_files.h"

namespace sextant {
namespace {

cv::Mat gradient(int width, int height) {
  cv::Mat image(height, width, CV_8UC3);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      image.at<cv::Vec3b>(y, x) = cv::Vec3b(static_cast<std::uint8_t>(255 * x / width),
                                            static_cast<std::uint8_t>(255 * y / height), 40);
    }
  }
  return image;
}

FileBytes jpeg_bytes(const cv::Mat& image) {
  tjhandle context = tjInitCompress();
  unsigned char* data = nullptr;
  unsigned long size = 0;
  EXPECT_EQ(
      tjCompress2(context, image.data, image.cols, 0, image.rows, TJPF_RGB, &data, &size, TJSAMP_444, 95, 0),
      0);
  const auto* bytes = reinterpret_cast<const std::byte*>(data);
  FileBytes out(bytes, bytes + size);
  tjFree(data);
  tjDestroy(context);
  return out;
}

TEST(Texture, PngIsExact) {
  const cv::Mat image = gradient(37, 23);
  const cv::Mat back = decode_texture(png_bytes(image), "t.png");
  ASSERT_EQ(back.type(), CV_8UC3);
  ASSERT_EQ(back.size(), image.size());
  EXPECT_EQ(std::memcmp(back.data, image.data, image.total() * 3), 0);
}

TEST(Texture, JpegIsClose) {
  const cv::Mat image = gradient(64, 48);
  const cv::Mat back = decode_texture(jpeg_bytes(image), "t.jpg");
  ASSERT_EQ(back.size(), image.size());
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      for (int k = 0; k < 3; ++k) {
        EXPECT_NEAR(back.at<cv::Vec3b>(y, x)[k], image.at<cv::Vec3b>(y, x)[k], 8);
      }
    }
  }
}

TEST(Texture, TooLargeIsRefusedBeforeItIsDecoded) {
  // A PNG header that promises 60000 x 60000 pixels: its check sum is right, its data is not there.
  FileBytes png = png_bytes(gradient(8, 8));
  const unsigned char side[] = {0, 0, 0xea, 0x60};
  std::memcpy(png.data() + 16, side, 4);
  std::memcpy(png.data() + 20, side, 4);
  EXPECT_THROW(decode_texture(png, "t.png"), InputError);
  FileBytes jpeg = jpeg_bytes(gradient(8, 8));
  for (std::size_t i = 0; i + 9 < jpeg.size(); ++i) {
    if (jpeg[i] != std::byte{0xff} || jpeg[i + 1] != std::byte{0xc0}) continue;
    for (const std::size_t k : {5U, 7U}) {
      jpeg[i + k] = std::byte{0xea};
      jpeg[i + k + 1] = std::byte{0x60};
    }
  }
  EXPECT_THAT(input_error_of([&] { decode_texture(jpeg, "t.jpg"); }), testing::HasSubstr("60000 x 60000"));
}

TEST(Texture, DamageIsRefusedOrDecoded) {
  std::mt19937_64 random(3);
  for (const FileBytes& whole : {png_bytes(gradient(40, 30)), jpeg_bytes(gradient(40, 30))}) {
    int refused = 0;
    for (int i = 0; i < 1000; ++i) {
      FileBytes bad = whole;
      if (i % 2 == 0) bad.resize(random() % bad.size());
      if (!bad.empty() && i % 3 != 0) bad[random() % bad.size()] = static_cast<std::byte>(random());
      try {
        const cv::Mat image = decode_texture(bad, "t");
        EXPECT_LE(image.cols, kMaxTextureSide);
        EXPECT_LE(image.rows, kMaxTextureSide);
      } catch (const InputError&) {
        ++refused;
      }
    }
    EXPECT_GT(refused, 300);
  }
}

}  // namespace
}  // namespace sextant
