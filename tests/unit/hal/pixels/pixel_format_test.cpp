// SPDX-License-Identifier: Apache-2.0
#include "hal/pixel_format.h"

#include <gtest/gtest.h>
#include <linux/videodev2.h>

namespace sextant {
namespace {

TEST(PixelFormat, CodesAreTheKernels) {
  EXPECT_EQ(format_of_fourcc(V4L2_PIX_FMT_YUYV), PixelFormat::kYuyv);
  EXPECT_EQ(format_of_fourcc(V4L2_PIX_FMT_UYVY), PixelFormat::kUyvy);
  EXPECT_EQ(format_of_fourcc(V4L2_PIX_FMT_NV12), PixelFormat::kNv12);
  EXPECT_EQ(format_of_fourcc(V4L2_PIX_FMT_MJPEG), PixelFormat::kMjpeg);
  EXPECT_EQ(format_of_fourcc(V4L2_PIX_FMT_JPEG), PixelFormat::kMjpeg);
  EXPECT_EQ(format_of_fourcc(V4L2_PIX_FMT_RGB24), PixelFormat::kRgb24);
  EXPECT_EQ(format_of_fourcc(V4L2_PIX_FMT_BGR24), PixelFormat::kBgr24);
  EXPECT_EQ(format_of_fourcc(V4L2_PIX_FMT_GREY), PixelFormat::kGrey);
  EXPECT_EQ(format_of_fourcc(V4L2_PIX_FMT_Z16), PixelFormat::kZ16);
  EXPECT_EQ(format_of_fourcc(V4L2_PIX_FMT_Y16), PixelFormat::kY16);
  EXPECT_EQ(format_of_fourcc(V4L2_PIX_FMT_Y10), PixelFormat::kY10);
  EXPECT_EQ(format_of_fourcc(V4L2_PIX_FMT_Y12), PixelFormat::kY12);
  EXPECT_EQ(format_of_fourcc(V4L2_PIX_FMT_Y10BPACK), PixelFormat::kY10Bpack);
  EXPECT_FALSE(format_of_fourcc(V4L2_PIX_FMT_H264).has_value());
  EXPECT_FALSE(format_of_fourcc(0).has_value());
  EXPECT_EQ(fourcc_text(V4L2_PIX_FMT_Z16), "Z16 ");
  EXPECT_EQ(fourcc_text(0x01020304), "????");
}

TEST(PixelFormat, NamesAreReadGenerously) {
  for (std::size_t i = 0; i < kPixelFormats; ++i) {
    const auto format = static_cast<PixelFormat>(i);
    EXPECT_EQ(info_of(format).format, format);  // the table is in the order of the enumeration
    EXPECT_EQ(format_named(info_of(format).name), format);
    EXPECT_NE(info_of(format).is_colour, info_of(format).is_depth);
  }
  EXPECT_EQ(format_named("z16 "), PixelFormat::kZ16);
  EXPECT_EQ(format_named("mjpeg"), PixelFormat::kMjpeg);
  EXPECT_FALSE(format_named("").has_value());
  EXPECT_FALSE(format_named("H264").has_value());
}

TEST(PixelFormat, SizesInBytes) {
  EXPECT_EQ(image_bytes(PixelFormat::kYuyv, 640, 480, 1280), 614400U);
  EXPECT_EQ(image_bytes(PixelFormat::kYuyv, 640, 480, 1500), 1500U * 479 + 1280);
  EXPECT_EQ(image_bytes(PixelFormat::kNv12, 640, 480, 640), 640U * 720);
  EXPECT_EQ(image_bytes(PixelFormat::kY10Bpack, 640, 480, 800), 384000U);  // gspca's Kinect
  EXPECT_EQ(least_stride(PixelFormat::kY11Bpack, 640), 880U);
  EXPECT_EQ(image_bytes(PixelFormat::kMjpeg, 640, 480, 0), 0U);
}

}  // namespace
}  // namespace sextant
