// SPDX-License-Identifier: Apache-2.0
// Depth decoding: bit packing against a writer of its own, scales, the Kinect's disparity against published
// values.
#include <gmock/gmock.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "hal/pixels/decode.h"
#include "runtime/base/error.h"

namespace sextant {
namespace {

constexpr int kWidth = 40;
constexpr int kHeight = 6;

std::vector<std::uint16_t> values_of(int bits) {
  std::mt19937 random(2);
  std::vector<std::uint16_t> values(kWidth * kHeight);
  for (auto& v : values) v = static_cast<std::uint16_t>(random() % (1U << bits));
  return values;
}

/// Bit by bit, most significant first.
std::vector<std::byte> packed(const std::vector<std::uint16_t>& values, int bits) {
  std::vector<std::byte> bytes((values.size() * static_cast<std::size_t>(bits) + 7) / 8);
  std::size_t at = 0;
  for (const std::uint16_t value : values) {
    for (int bit = bits - 1; bit >= 0; --bit, ++at) {
      if ((value >> bit & 1) != 0) bytes[at / 8] |= static_cast<std::byte>(0x80 >> at % 8);
    }
  }
  return bytes;
}

std::vector<std::byte> plain(const std::vector<std::uint16_t>& values) {
  std::vector<std::byte> bytes(values.size() * 2);
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

RawImage raw(PixelFormat format, const std::vector<std::byte>& bytes) {
  RawImage image;
  image.format = format;
  image.width = kWidth;
  image.height = kHeight;
  image.stride = bytes.size() / kHeight;
  image.bytes = bytes;
  return image;
}

TEST(DecodeDepth, EveryFormatGivesItsValues) {
  using enum PixelFormat;
  for (const auto& [format, bits] :
       {std::pair(kZ16, 16), {kY16, 16}, {kY12, 12}, {kY10, 10}, {kY10Bpack, 10}, {kY11Bpack, 11}}) {
    const auto values = values_of(bits);
    const auto bytes = format == kY10Bpack || format == kY11Bpack ? packed(values, bits) : plain(values);
    const cv::Mat got = decode_values(raw(format, bytes), "test");
    ASSERT_EQ(got.type(), CV_16UC1);
    for (int i = 0; i < kWidth * kHeight; ++i)
      ASSERT_EQ(got.at<std::uint16_t>(i / kWidth, i % kWidth), values[static_cast<std::size_t>(i)])
          << info_of(format).name;
  }
}

TEST(DecodeDepth, ScalesAndLimits) {
  std::vector<std::uint16_t> values(kWidth * kHeight, 0);
  values[1] = 1000;
  values[2] = 100;    // nearer than the limit
  values[3] = 65535;  // farther
  const auto bytes = plain(values);
  DepthScale scale;
  scale.metres_per_unit = 0.00025;
  scale.nearest_m = 0.1;
  scale.farthest_m = 4;
  const cv::Mat depth = decode_depth(raw(PixelFormat::kZ16, bytes), scale, "test");
  ASSERT_EQ(depth.type(), CV_32FC1);
  EXPECT_EQ(depth.at<float>(0, 0), 0);
  EXPECT_FLOAT_EQ(depth.at<float>(0, 1), 0.25F);
  EXPECT_EQ(depth.at<float>(0, 2), 0);
  EXPECT_EQ(depth.at<float>(0, 3), 0);
}

TEST(DecodeDepth, KinectDisparity) {
  // OpenKinect's wiki: raw 600 is some 0.67 m, 800 some 1.14 m, 1000 some 3.85 m; 2047 is nothing.
  std::vector<std::uint16_t> values(kWidth * kHeight, 2047);
  values[0] = 600;
  values[1] = 800;
  values[2] = 1000;
  values[3] = 1090;  // beyond the formula's pole
  DepthScale scale;
  scale.encoding = DepthScale::Encoding::kKinectDisparity;
  const auto bytes = packed(values, 11);
  const cv::Mat depth = decode_depth(raw(PixelFormat::kY11Bpack, bytes), scale, "test");
  EXPECT_NEAR(depth.at<float>(0, 0), 1 / (3.3309495161 - 600 * 0.0030711016), 1e-6);
  EXPECT_NEAR(depth.at<float>(0, 0), 0.67, 0.01);
  EXPECT_NEAR(depth.at<float>(0, 1), 1.14, 0.01);
  EXPECT_NEAR(depth.at<float>(0, 2), 3.85, 0.01);
  EXPECT_EQ(depth.at<float>(0, 3), 0);
  EXPECT_EQ(depth.at<float>(0, 4), 0);
  // The 10-bit stream has the upper bits.
  for (auto& v : values) v = static_cast<std::uint16_t>(v / 2);
  const auto short_bytes = packed(values, 10);
  const cv::Mat coarse = decode_depth(raw(PixelFormat::kY10Bpack, short_bytes), scale, "test");
  EXPECT_NEAR(coarse.at<float>(0, 1), 1.14, 0.01);
  EXPECT_EQ(coarse.at<float>(0, 4), 0);
  EXPECT_THROW(decode_depth(raw(PixelFormat::kZ16, plain(values)), scale, "test"), InputError);
}

TEST(DecodeDepth, FloatsAreMetresAndHolesAreZero) {
  std::vector<float> values(kWidth * kHeight, 1.5F);
  values[0] = std::numeric_limits<float>::quiet_NaN();
  values[1] = std::numeric_limits<float>::infinity();
  values[2] = -1;
  values[3] = 0;
  std::vector<std::byte> bytes(values.size() * 4);
  std::memcpy(bytes.data(), values.data(), bytes.size());
  const cv::Mat depth = decode_depth(raw(PixelFormat::kFloat32, bytes), {}, "test");
  for (int i = 0; i < 4; ++i) EXPECT_EQ(depth.at<float>(0, i), 0) << i;
  EXPECT_EQ(depth.at<float>(0, 4), 1.5F);
  EXPECT_THROW(decode_values(raw(PixelFormat::kFloat32, bytes), "test"), InputError);
}

TEST(DecodeDepth, RefusesWhatDoesNotFit) {
  const auto bytes = plain(values_of(16));
  RawImage image = raw(PixelFormat::kZ16, bytes);
  image.bytes = image.bytes.first(bytes.size() - 1);
  EXPECT_THROW(decode_depth(image, {}, "test"), InputError);
  EXPECT_THROW(decode_depth(raw(PixelFormat::kYuyv, bytes), {}, "test"), InputError);
}

}  // namespace
}  // namespace sextant
