// SPDX-License-Identifier: Apache-2.0
// Round trips through real files, every PNG flavour that data sets use, and the refusals at the door.
#include "hal/image/image_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spng.h>
#include <sys/stat.h>
#include <turbojpeg.h>
#include <unistd.h>

#include <fstream>
#include <random>

#include "hal/image/file_bytes.h"
#include "runtime/base/error.h"

namespace sextant {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class ImageFile : public testing::Test {
 protected:
  ImageFile() : folder_(fs::temp_directory_path() / ("image_file_test_" + std::to_string(::getpid()))) {
    fs::create_directories(folder_);
  }
  ~ImageFile() override {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  fs::path folder_;
};

cv::Mat random_image(int width, int height, int type, std::uint32_t seed) {
  std::mt19937 random(seed);
  cv::Mat image(height, width, type);
  for (std::size_t i = 0; i < image.total() * image.elemSize(); ++i) {
    image.data[i] = static_cast<unsigned char>(random());
  }
  return image;
}

bool same(const cv::Mat& a, const cv::Mat& b) {
  if (a.size() != b.size() || a.type() != b.type()) return false;
  for (int row = 0; row < a.rows; ++row) {
    if (std::memcmp(a.ptr(row), b.ptr(row), static_cast<std::size_t>(a.cols) * a.elemSize()) != 0)
      return false;
  }
  return true;
}

/// A PNG of any colour type, made by the library alone.
std::vector<std::byte> library_png(int width, int height, std::uint8_t colour_type, std::uint8_t bit_depth,
                                   const std::vector<unsigned char>& pixels,
                                   const spng_plte* palette = nullptr) {
  spng_ctx* context = spng_ctx_new(SPNG_CTX_ENCODER);
  spng_ihdr header{};
  header.width = static_cast<std::uint32_t>(width);
  header.height = static_cast<std::uint32_t>(height);
  header.color_type = colour_type;
  header.bit_depth = bit_depth;
  spng_set_option(context, SPNG_ENCODE_TO_BUFFER, 1);
  spng_set_ihdr(context, &header);
  spng_plte copy{};
  if (palette) {
    copy = *palette;
    spng_set_plte(context, &copy);
  }
  EXPECT_EQ(0, spng_encode_image(context, pixels.data(), pixels.size(), SPNG_FMT_PNG, SPNG_ENCODE_FINALIZE));
  std::size_t size = 0;
  int error = 0;
  void* buffer = spng_get_png_buffer(context, &size, &error);
  std::vector<std::byte> bytes(static_cast<std::byte*>(buffer), static_cast<std::byte*>(buffer) + size);
  std::free(buffer);
  spng_ctx_free(context);
  return bytes;
}

TEST_F(ImageFile, PngRoundTripsAnySize) {
  std::mt19937 random(1);
  for (std::uint32_t i = 0; i < 40; ++i) {
    const int width = 1 + static_cast<int>(random() % 70);
    const int height = 1 + static_cast<int>(random() % 70);
    const int type = i % 2 ? CV_16UC1 : CV_8UC3;
    const cv::Mat image = random_image(width, height, type, i);
    const fs::path file = folder_ / "round.png";
    write_png(file, image);
    EXPECT_TRUE(same(image, i % 2 ? read_depth_image(file) : read_colour_image(file)));
  }
  EXPECT_EQ(1, std::distance(fs::directory_iterator(folder_), {})) << "temporary files stay behind";
}

TEST_F(ImageFile, AViewIntoALargerImageIsWrittenAsItLooks) {
  const cv::Mat large = random_image(40, 30, CV_16UC1, 3);
  const cv::Mat view = large(cv::Rect(5, 6, 11, 13));
  EXPECT_TRUE(same(view, decode_png(encode_png(view), "view")));
}

TEST_F(ImageFile, GreyPaletteAndAlphaBecomeRgb) {
  const cv::Mat grey = decode_image(library_png(2, 1, SPNG_COLOR_TYPE_GRAYSCALE, 8, {10, 200}), "grey");
  ASSERT_EQ(CV_8UC3, grey.type());
  EXPECT_EQ(cv::Vec3b(10, 10, 10), grey.at<cv::Vec3b>(0, 0));
  EXPECT_EQ(cv::Vec3b(200, 200, 200), grey.at<cv::Vec3b>(0, 1));

  const cv::Mat alpha = decode_image(
      library_png(2, 1, SPNG_COLOR_TYPE_TRUECOLOR_ALPHA, 8, {1, 2, 3, 0, 250, 251, 252, 255}), "alpha");
  EXPECT_EQ(cv::Vec3b(1, 2, 3), alpha.at<cv::Vec3b>(0, 0));
  EXPECT_EQ(cv::Vec3b(250, 251, 252), alpha.at<cv::Vec3b>(0, 1));

  spng_plte palette{};
  palette.n_entries = 2;
  palette.entries[0] = {9, 8, 7, 255};
  palette.entries[1] = {100, 110, 120, 255};
  // One bit per pixel: 0, 1, 1.
  const cv::Mat indexed =
      decode_image(library_png(3, 1, SPNG_COLOR_TYPE_INDEXED, 1, {0x60}, &palette), "palette");
  EXPECT_EQ(cv::Vec3b(9, 8, 7), indexed.at<cv::Vec3b>(0, 0));
  EXPECT_EQ(cv::Vec3b(100, 110, 120), indexed.at<cv::Vec3b>(0, 1));
  EXPECT_EQ(cv::Vec3b(100, 110, 120), indexed.at<cv::Vec3b>(0, 2));
}

TEST_F(ImageFile, JpegKeepsTheOrderOfChannels) {
  cv::Mat image(48, 64, CV_8UC3, cv::Scalar(220, 120, 20));
  tjhandle handle = tjInitCompress();
  unsigned char* buffer = nullptr;
  unsigned long size = 0;
  ASSERT_EQ(0, tjCompress2(handle, image.data, 64, 0, 48, TJPF_RGB, &buffer, &size, TJSAMP_444, 95, 0));
  {
    std::ofstream out(folder_ / "a.jpg", std::ios::binary);
    out.write(reinterpret_cast<char*>(buffer), static_cast<std::streamsize>(size));
  }
  tjFree(buffer);
  tjDestroy(handle);
  const cv::Mat read = read_colour_image(folder_ / "a.jpg");
  ASSERT_EQ(image.size(), read.size());
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(image.at<cv::Vec3b>(20, 20)[c], read.at<cv::Vec3b>(20, 20)[c], 3);
}

TEST_F(ImageFile, RefusalsNameTheFileAndTheReason) {
  const auto reason = [](const auto& call) -> std::string {
    try {
      call();
    } catch (const InputError& error) {
      return error.what();
    }
    return "nothing was thrown";
  };
  const fs::path colour = folder_ / "colour.png";
  const fs::path depth = folder_ / "depth.png";
  write_png(colour, random_image(8, 8, CV_8UC3, 1));
  write_png(depth, random_image(8, 8, CV_16UC1, 1));
  EXPECT_THAT(reason([&] { read_depth_image(colour); }), HasSubstr(colour.string() + ": is no depth image"));
  EXPECT_THAT(reason([&] { read_colour_image(depth); }), HasSubstr("16-bit grey"));
  EXPECT_THAT(reason([&] { read_colour_image(folder_ / "none.png"); }), HasSubstr("does not exist"));
  EXPECT_THAT(reason([&] { read_colour_image(folder_); }), HasSubstr("not a regular file"));
  const fs::path pipe = folder_ / "pipe";
  ASSERT_EQ(0, ::mkfifo(pipe.c_str(), 0600));
  EXPECT_THAT(reason([&] { read_colour_image(pipe); }), HasSubstr("not a regular file"));
  std::ofstream(folder_ / "text.png") << "hello";
  EXPECT_THAT(reason([&] { read_colour_image(folder_ / "text.png"); }),
              HasSubstr("neither a PNG nor a JPEG"));
  std::ofstream(folder_ / "empty.png").flush();
  EXPECT_THAT(reason([&] { read_colour_image(folder_ / "empty.png"); }), HasSubstr("neither"));
  EXPECT_THAT(reason([&] { write_png(folder_ / "no" / "a.png", random_image(2, 2, CV_8UC3, 1)); }),
              HasSubstr("cannot be written"));
  EXPECT_THAT(reason([&] { read_file_bytes(colour, 10); }), HasSubstr("more than the limit of 10"));
  EXPECT_THROW(encode_png(cv::Mat(2, 2, CV_32FC1)), std::invalid_argument);
}

}  // namespace
}  // namespace sextant
