// SPDX-License-Identifier: Apache-2.0
// Thousands of damaged images: each must decode to a sane picture or be refused with the file's name, never
// crash (run it under the asan preset too). PNG checksums are repaired after half of the mutations, so that
// the damage reaches the decoder behind them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <turbojpeg.h>

#include <array>
#include <cstring>
#include <random>

#include "hal/image/image_file.h"
#include "runtime/base/error.h"

namespace sextant {
namespace {

using Bytes = std::vector<std::byte>;

cv::Mat picture(int type) {
  cv::Mat image(37, 53, type);
  std::mt19937 random(4);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const int noise = static_cast<int>(random() % 16);
      if (type == CV_8UC3) {
        image.at<cv::Vec3b>(y, x) =
            cv::Vec3b(static_cast<unsigned char>(4 * x + noise), static_cast<unsigned char>(5 * y),
                      static_cast<unsigned char>(noise));
      } else {
        image.at<std::uint16_t>(y, x) = static_cast<std::uint16_t>(8000 + 40 * x + noise);
      }
    }
  }
  return image;
}

Bytes jpeg(bool progressive) {
  const cv::Mat image = picture(CV_8UC3);
  tjhandle handle = tjInitCompress();
  unsigned char* buffer = nullptr;
  unsigned long size = 0;
  EXPECT_EQ(0, tjCompress2(handle, image.data, image.cols, 0, image.rows, TJPF_RGB, &buffer, &size,
                           TJSAMP_420, 80, progressive ? TJFLAG_PROGRESSIVE : 0));
  const auto* first = reinterpret_cast<std::byte*>(buffer);
  Bytes bytes(first, first + size);
  tjFree(buffer);
  tjDestroy(handle);
  return bytes;
}

std::uint32_t crc32(const std::byte* data, std::size_t size) {
  std::uint32_t crc = 0xFFFFFFFFU;
  for (std::size_t i = 0; i < size; ++i) {
    crc ^= static_cast<std::uint32_t>(data[i]);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1U) ? 0xEDB88320U : 0U);
  }
  return ~crc;
}

void repair_checksums(Bytes& png) {
  std::size_t at = 8;
  while (at + 12 <= png.size()) {
    std::uint32_t length = 0;
    for (std::size_t i = 0; i < 4; ++i) length = (length << 8) | static_cast<std::uint32_t>(png[at + i]);
    if (length > png.size() - at - 12) return;
    const std::uint32_t crc = crc32(&png[at + 4], length + 4);
    for (std::size_t i = 0; i < 4; ++i)
      png[at + 8 + length + i] = static_cast<std::byte>(crc >> (24 - 8 * i));
    at += 12 + length;
  }
}

/// True where it decoded.
bool decodes_or_is_refused(const Bytes& bytes) {
  try {
    const cv::Mat image = decode_image(bytes, "damaged.file");
    EXPECT_TRUE(image.type() == CV_8UC3 || image.type() == CV_16UC1);
    EXPECT_GT(image.total(), 0U);
    EXPECT_LE(image.total(), kMaxImagePixels);
    // Touch every byte: a sanitizer sees what was never written or is out of range.
    unsigned sum = 0;
    for (std::size_t i = 0; i < image.total() * image.elemSize(); ++i) sum += image.data[i];
    EXPECT_GE(sum, 0U);
    return true;
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::StartsWith("damaged.file: "));
    return false;
  }
}

class DamagedImage : public testing::TestWithParam<int> {
 protected:
  static Bytes original() {
    switch (GetParam()) {
      case 0:
        return encode_png(picture(CV_8UC3));
      case 1:
        return encode_png(picture(CV_16UC1));
      case 2:
        return jpeg(false);
      default:
        return jpeg(true);
    }
  }
  static bool is_png() { return GetParam() < 2; }
};

TEST_P(DamagedImage, TruncationIsRefused) {
  const Bytes bytes = original();
  ASSERT_TRUE(decodes_or_is_refused(bytes));
  // The last bytes may be dispensable (PNG's IEND chunk, JPEG's end marker); everything before them is not.
  const std::size_t tail = is_png() ? 16 : 2;
  for (std::size_t size = 0; size < bytes.size(); size += size < 200 ? 1 : 7) {
    const bool decoded =
        decodes_or_is_refused(Bytes(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)));
    EXPECT_FALSE(decoded && size + tail < bytes.size()) << size << " of " << bytes.size();
  }
}

TEST_P(DamagedImage, FlippedBytesNeverCrash) {
  const Bytes bytes = original();
  std::mt19937 random(static_cast<std::uint32_t>(11 + GetParam()));
  int refused = 0;
  for (int i = 0; i < 4000; ++i) {
    Bytes damaged = bytes;
    const std::size_t count = 1 + random() % 6;
    for (std::size_t k = 0; k < count; ++k) {
      // Headers decide most: half of the hits go to the first 64 bytes.
      const std::size_t range = random() % 2 ? damaged.size() : std::min<std::size_t>(64, damaged.size());
      damaged[random() % range] = static_cast<std::byte>(random());
    }
    if (random() % 8 == 0) {
      const std::size_t at = random() % damaged.size();
      damaged.insert(damaged.begin() + static_cast<std::ptrdiff_t>(at), 1 + random() % 40,
                     static_cast<std::byte>(random()));
    }
    if (is_png() && i % 2) repair_checksums(damaged);
    refused += decodes_or_is_refused(damaged) ? 0 : 1;
  }
  EXPECT_GT(refused, 400) << "the damage is too gentle to test anything";
}

INSTANTIATE_TEST_SUITE_P(PngRgbPngDepthJpegProgressive, DamagedImage, testing::Values(0, 1, 2, 3));

TEST(DamagedPng, HugeSizesAreRefusedBeforeAnyAllocation) {
  for (const int type : {CV_8UC3, CV_16UC1}) {
    for (const auto& [width, height] :
         {std::pair{0x7FFFFFFFU, 0x7FFFFFFFU}, {20000U, 10U}, {16384U, 16384U}, {8192U, 8192U}}) {
      Bytes damaged = encode_png(picture(type));
      for (std::size_t i = 0; i < 4; ++i) {
        damaged[16 + i] = static_cast<std::byte>(width >> (24 - 8 * i));
        damaged[20 + i] = static_cast<std::byte>(height >> (24 - 8 * i));
      }
      repair_checksums(damaged);
      EXPECT_FALSE(decodes_or_is_refused(damaged));
    }
  }
}

}  // namespace
}  // namespace sextant
