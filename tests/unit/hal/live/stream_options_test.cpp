// SPDX-License-Identifier: Apache-2.0
#include "hal/live/stream_options.h"

#include <gtest/gtest.h>

#include "runtime/base/error.h"

namespace sextant {
namespace {

template <typename Change>
bool refused(Change change) {
  StreamOptions options;
  options.device = "camera";
  change(options);
  try {
    check_stream_options(options);
    return false;
  } catch (const UsageError&) {
    return true;
  }
}

TEST(StreamOptions, RangesAreChecked) {
  EXPECT_FALSE(refused([](StreamOptions&) {}));
  EXPECT_TRUE(refused([](StreamOptions& o) { o.device.clear(); }));
  EXPECT_TRUE(refused([](StreamOptions& o) { o.width = 0; }));
  EXPECT_TRUE(refused([](StreamOptions& o) { o.height = 20000; }));
  EXPECT_TRUE(refused([](StreamOptions& o) { o.rate_hz = -1; }));
  EXPECT_TRUE(refused([](StreamOptions& o) { o.buffers = 1; }));
  EXPECT_TRUE(refused([](StreamOptions& o) { o.watchdog = std::chrono::milliseconds(1); }));
  EXPECT_TRUE(refused([](StreamOptions& o) { o.max_age = std::chrono::milliseconds(-1); }));
  EXPECT_TRUE(refused([](StreamOptions& o) { o.format = "H264"; }));
}

TEST(StreamOptions, AFormatFitsItsPurpose) {
  EXPECT_FALSE(refused([](StreamOptions& o) { o.format = "MJPEG"; }));
  EXPECT_TRUE(refused([](StreamOptions& o) { o.format = "Z16"; }));
  EXPECT_FALSE(refused([](StreamOptions& o) {
    o.depth = true;
    o.format = "Z16";
  }));
  EXPECT_TRUE(refused([](StreamOptions& o) {
    o.depth = true;
    o.format = "YUYV";
  }));
}

}  // namespace
}  // namespace sextant
