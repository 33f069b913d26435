// SPDX-License-Identifier: Apache-2.0
// Images and calibrations from the wire: good ones of every encoding, and bad ones.
#include "hal/dds/image_message.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "hal/pixels/decode.h"
#include "runtime/base/error.h"
#include "test_messages.h"

namespace sextant {
namespace {

std::string refusal(const ImageMessage& message, ImageKind kind) {
  try {
    raw_image_of(message, kind, read_clocks(), "cam/image");
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

cv::Vec3b colour_of(TestImage& image) {
  const RawImage raw = raw_image_of(image.message(), ImageKind::kColour, read_clocks(), "t");
  return decode_colour(raw, "t").at<cv::Vec3b>(3, 5);
}

TEST(ImageMessage, EveryColourEncoding) {
  const std::vector<std::pair<std::string, std::vector<int>>> cases{{"rgb8", {10, 20, 30}},
                                                                    {"bgr8", {30, 20, 10}},
                                                                    {"8UC3", {30, 20, 10}},
                                                                    {"rgba8", {10, 20, 30, 99}},
                                                                    {"bgra8", {30, 20, 10, 99}}};
  for (const auto& [encoding, pixel] : cases) {
    TestImage image(encoding, 32, 24, static_cast<unsigned>(pixel.size()), 4);
    image.fill(pixel);
    EXPECT_EQ(colour_of(image), cv::Vec3b(10, 20, 30)) << encoding;
  }
  for (const char* encoding : {"mono8", "8UC1"}) {
    TestImage image(encoding, 32, 24, 1, 8);
    image.fill({77});
    EXPECT_EQ(colour_of(image), cv::Vec3b(77, 77, 77)) << encoding;
  }
  // Grey of medium brightness in YUV: U and V 128.
  for (const char* encoding : {"yuv422", "uyvy"}) {
    TestImage image(encoding, 32, 24, 2, 0);
    image.fill({128, 126});
    const cv::Vec3b pixel = colour_of(image);
    EXPECT_NEAR(pixel[0], 128, 2) << encoding;
    EXPECT_NEAR(pixel[2], 128, 2) << encoding;
  }
  for (const char* encoding : {"yuv422_yuy2", "yuyv"}) {
    TestImage image(encoding, 32, 24, 2, 0);
    image.fill({126, 128});
    EXPECT_NEAR(colour_of(image)[1], 128, 2) << encoding;
  }
}

TEST(ImageMessage, DepthInBothEncodingsAndByteOrders) {
  for (const char* encoding : {"16UC1", "mono16"}) {
    for (const bool big : {false, true}) {
      TestImage image(encoding, 32, 24, 2, 6);
      image.fill(big ? std::vector<int>{0x03, 0x20} : std::vector<int>{0x20, 0x03});  // 800
      image.message().is_bigendian = big;
      const RawImage raw = raw_image_of(image.message(), ImageKind::kDepth, read_clocks(), "t");
      EXPECT_FLOAT_EQ(decode_depth(raw, {}, "t").at<float>(7, 9), 0.8F) << encoding << big;
    }
  }
  const float metres = 1.25F;
  std::array<unsigned char, 4> bytes{};
  std::memcpy(bytes.data(), &metres, 4);
  TestImage image("32FC1", 32, 24, 4, 0);
  image.fill({bytes[0], bytes[1], bytes[2], bytes[3]});
  const RawImage raw = raw_image_of(image.message(), ImageKind::kDepth, read_clocks(), "t");
  EXPECT_FLOAT_EQ(decode_depth(raw, {}, "t").at<float>(7, 9), 1.25F);
}

TEST(ImageMessage, CarriesTheStampOnBothClocks) {
  TestImage image("rgb8", 32, 24, 3, 0);
  image.message().header.stamp = {1'700'000'000, 500};
  const CaptureStamp clocks = read_clocks();
  const RawImage raw = raw_image_of(image.message(), ImageKind::kColour, clocks, "t");
  EXPECT_EQ(raw.captured.realtime.time_since_epoch(),
            std::chrono::seconds(1'700'000'000) + std::chrono::nanoseconds(500));
  EXPECT_EQ(clocks.realtime - raw.captured.realtime, clocks.monotonic - raw.captured.monotonic);
}

TEST(ImageMessage, RefusesWhatDoesNotKeepItsPromise) {
  TestImage good("rgb8", 32, 24, 3, 0);
  EXPECT_EQ(refusal(good.message(), ImageKind::kColour), "accepted");
  EXPECT_THAT(refusal(good.message(), ImageKind::kDepth), testing::HasSubstr("16UC1, mono16, 32FC1"));
  {
    TestImage bad("bayer_\x1b[31m", 32, 24, 3, 0);
    const std::string text = refusal(bad.message(), ImageKind::kColour);
    EXPECT_THAT(text, testing::HasSubstr("\"bayer_?[31m\""));
  }
  const auto spoilt = [&](auto spoil) {
    TestImage image("rgb8", 32, 24, 3, 0);
    spoil(image.message());
    return refusal(image.message(), ImageKind::kColour);
  };
  EXPECT_THAT(spoilt([](ImageMessage& m) { m.width = 0; }), testing::HasSubstr("0 x 24"));
  EXPECT_THAT(spoilt([](ImageMessage& m) { m.width = 0xFFFFFFFF; }), testing::HasSubstr("pixels"));
  EXPECT_THAT(spoilt([](ImageMessage& m) { m.height = 16384; }), testing::HasSubstr("bytes of data instead"));
  EXPECT_THAT(spoilt([](ImageMessage& m) { m.step = 95; }), testing::HasSubstr("too short"));
  EXPECT_THAT(spoilt([](ImageMessage& m) { m.step = 0xFFFFFFFF; }),
              testing::HasSubstr("bytes of data instead"));
  EXPECT_THAT(spoilt([](ImageMessage& m) { m.data._length -= 1; }),
              testing::HasSubstr("bytes of data instead"));
  EXPECT_THAT(spoilt([](ImageMessage& m) { m.data._buffer = nullptr; }),
              testing::HasSubstr("bytes of data instead"));
  EXPECT_THAT(spoilt([](ImageMessage& m) { m.header.stamp.nanosec = 1'000'000'000; }),
              testing::HasSubstr("no time"));
  EXPECT_THAT(spoilt([](ImageMessage& m) { m.header.stamp.sec = -1; }), testing::HasSubstr("no time"));
  EXPECT_THAT(spoilt([](ImageMessage& m) { m.encoding = nullptr; }), testing::HasSubstr("encoding"));
  EXPECT_THAT(spoilt([](ImageMessage& m) { m.header.frame_id = nullptr; }), testing::HasSubstr("frame_id"));
}

TEST(CameraInfo, GoodOnes) {
  TestInfo info(640, 480, 600);
  EXPECT_EQ(camera_of(info.message(), "t").fx, 600);
  info.set_distortion("plumb_bob", {0.1, -0.2, 0.001, 0.002, 0.05});
  EXPECT_EQ(camera_of(info.message(), "t").distortion[4], 0.05);
  info.set_distortion("rational_polynomial", {0.1, -0.2, 0.001, 0.002, 0.05, 0.01, 0.02, 0.03});
  EXPECT_EQ(camera_of(info.message(), "t").distortion[7], 0.03);
  info.set_distortion("equidistant", {0, 0, 0, 0});  // no distortion at all is none of any kind
  EXPECT_FALSE(camera_of(info.message(), "t").has_distortion());
}

TEST(CameraInfo, BadOnes) {
  const auto refuses = [](auto spoil) {
    TestInfo info(640, 480, 600);
    spoil(info);
    EXPECT_THROW(camera_of(info.message(), "t"), InputError);
  };
  refuses([](TestInfo& i) { i.message().k[0] = 0; });
  refuses([](TestInfo& i) { i.message().k[0] = std::numeric_limits<double>::quiet_NaN(); });
  refuses([](TestInfo& i) { i.message().k[1] = 3; });
  refuses([](TestInfo& i) { i.message().width = 0; });
  refuses([](TestInfo& i) { i.message().width = 0xFFFFFFFF; });
  refuses([](TestInfo& i) { i.message().binning_x = 2; });
  refuses([](TestInfo& i) { i.message().roi.width = 100; });
  refuses([](TestInfo& i) { i.set_distortion("equidistant", {0.1, 0, 0, 0}); });
  refuses([](TestInfo& i) { i.set_distortion("plumb_bob", {0.1}); });
  refuses([](TestInfo& i) { i.set_distortion("plumb_bob", std::vector<double>(1000, 0.1)); });
  refuses([](TestInfo& i) {
    i.set_distortion("plumb_bob", {0.1, std::numeric_limits<double>::infinity(), 0, 0, 0});
  });
}

}  // namespace
}  // namespace sextant
