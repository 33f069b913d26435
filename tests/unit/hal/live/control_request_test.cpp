// SPDX-License-Identifier: Apache-2.0
#include "hal/live/control_request.h"

#include <gmock/gmock.h>

#include "hal/live/whole_jpeg.h"
#include "runtime/base/error.h"

namespace sextant {
namespace {

using testing::HasSubstr;

std::vector<CameraControl> known() {
  CameraControl gain;
  gain.name = "gain";
  gain.lowest = 0;
  gain.highest = 64;
  CameraControl line;
  line.name = "power_line_frequency";
  line.lowest = 0;
  line.highest = 3;
  line.menu = {"Disabled", "50 Hz", "60 Hz", ""};
  CameraControl fixed;
  fixed.name = "privacy";
  fixed.highest = 1;
  fixed.read_only = true;
  return {gain, line, fixed};
}

std::int64_t value(const std::string& text) { return read_control_request(text, known(), "camera").value; }

std::string refusal(const std::string& text) {
  try {
    value(text);
  } catch (const DeviceError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(ControlRequest, ReadsNumbersSwitchesAndMenus) {
  EXPECT_EQ(value("gain=16"), 16);
  EXPECT_EQ(value("Gain = 64 "), 64);
  EXPECT_EQ(value("gain=true"), 1);
  EXPECT_EQ(value("power_line_frequency=50 Hz"), 1);
  EXPECT_EQ(value("Power Line Frequency=60 hz"), 2);
  EXPECT_EQ(value("power_line_frequency=0"), 0);
}

TEST(ControlRequest, RefusalsSayWhatToWrite) {
  EXPECT_THAT(refusal("gain"), HasSubstr("no name=value"));
  EXPECT_THAT(refusal("gainn=3"), HasSubstr("it has gain, power_line_frequency"));
  EXPECT_THAT(refusal("gain=65"), HasSubstr("use 0 to 64"));
  EXPECT_THAT(refusal("gain=-1"), HasSubstr("use 0 to 64"));
  EXPECT_THAT(refusal("gain="), HasSubstr("use 0 to 64"));
  EXPECT_THAT(refusal("gain=1.5"), HasSubstr("use 0 to 64"));
  EXPECT_THAT(refusal("gain=99999999999999999999"), HasSubstr("use 0 to 64"));
  EXPECT_THAT(refusal("power_line_frequency=3"), HasSubstr("1 (50 Hz), 2 (60 Hz)"));
  EXPECT_THAT(refusal("power_line_frequency=55 Hz"), HasSubstr("0 (Disabled)"));
  EXPECT_THAT(refusal("privacy=1"), HasSubstr("cannot be set"));
  EXPECT_THAT(refusal("=1"), HasSubstr("no control ''"));
}

TEST(ControlName, IsAsV4l2CtlWritesIt) {
  EXPECT_EQ(control_name("Exposure Time, Absolute"), "exposure_time_absolute");
  EXPECT_EQ(control_name("White Balance, Automatic"), "white_balance_automatic");
  EXPECT_EQ(control_name("  (x)  "), "x");
  EXPECT_EQ(control_name(""), "");
}

TEST(WholeJpeg, SeesACutEnd) {
  const std::vector<std::byte> whole{std::byte{0xff}, std::byte{0xd8}, std::byte{1},
                                     std::byte{0xff}, std::byte{0xd9}, std::byte{0}};
  EXPECT_TRUE(is_whole_jpeg(whole));
  EXPECT_TRUE(is_whole_jpeg(std::span(whole).first(5)));
  for (std::size_t size = 0; size < 5; ++size) EXPECT_FALSE(is_whole_jpeg(std::span(whole).first(size)));
  EXPECT_FALSE(is_whole_jpeg(std::span(whole).subspan(1)));
}

}  // namespace
}  // namespace sextant
