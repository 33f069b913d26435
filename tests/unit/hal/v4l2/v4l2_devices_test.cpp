// SPDX-License-Identifier: Apache-2.0
// Identities on made-up /dev and /sys trees; what needs a real node is in tests/hardware.
#include "hal/v4l2/v4l2_devices.h"

#include <gmock/gmock.h>

#include <fstream>

#include "hal/libcamera/libcamera_source.h"
#include "hal/live/stream_session.h"
#include "hal/v4l2/v4l2_modes.h"
#include "tests/support/temporary_folder.h"

namespace sextant {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

class V4l2Places : public testing::Test {
 protected:
  /// A USB camera with one node that cannot be opened as a camera.
  void add(const std::string& node, const std::string& usb, const std::string& serial) {
    const fs::path device = places_.sys / "devices" / usb;
    fs::create_directories(device / "interface");
    std::ofstream(device / "idVendor") << "046d\n";
    if (!serial.empty()) std::ofstream(device / "serial") << serial << "\n";
    const fs::path entry = places_.sys / "class/video4linux" / node;
    fs::create_directories(entry);
    std::ofstream(entry / "name") << "HD Camera\n";
    fs::create_directory_symlink(device / "interface", entry / "device");
  }
  template <typename Error>
  std::string refusal(const std::string& id) const {
    try {
      open_v4l2_device(id, places_);
    } catch (const Error& error) {
      return error.what();
    }
    return "opened";
  }

  TemporaryFolder folder_;
  DevicePlaces places_{folder_ / "dev", folder_ / "sys"};
};

TEST_F(V4l2Places, WithoutDevicesTheListIsEmptyAndOpeningSaysSo) {
  EXPECT_TRUE(list_v4l2_devices(true, places_).empty());
  EXPECT_THAT(refusal<DeviceUnready>("serial:1"), HasSubstr("there are no V4L2 cameras"));
  EXPECT_THAT(refusal<DeviceError>(""), HasSubstr("no device is named"));
}

TEST_F(V4l2Places, ADeviceThatCannotBeOpenedIsListedWithItsReason) {
  add("video10", "usb1", "A1");
  add("video2", "usb2", "");
  add("v4l-subdev0", "usb3", "C3");
  const auto devices = list_v4l2_devices(true, places_);
  ASSERT_EQ(devices.size(), 2U);
  EXPECT_EQ(devices[0].node, (places_.dev / "video2").string());  // by number, not by letters
  EXPECT_EQ(devices[0].id, devices[0].node);                      // nothing stabler is known
  EXPECT_EQ(devices[1].serial, "A1");
  EXPECT_EQ(devices[1].id, "serial:A1");
  EXPECT_EQ(devices[1].name, "HD Camera");
  EXPECT_THAT(devices[1].problem, HasSubstr("cannot open it"));
}

TEST_F(V4l2Places, SerialsOfTwoNodesAreNumbered) {
  add("video0", "usb1", "A1");
  add("video1", "usb2", "A1");
  const auto devices = list_v4l2_devices(false, places_);
  EXPECT_EQ(devices[0].id, "serial:A1");
  EXPECT_EQ(devices[1].id, "serial:A1#1");
  EXPECT_THAT(refusal<DeviceUnready>("serial:A1#2"), HasSubstr("there are serial:A1, serial:A1#1"));
}

TEST_F(V4l2Places, WhatIsNoCameraIsRefused) {
  EXPECT_THAT(refusal<DeviceError>("/dev/null"), HasSubstr("no camera that streams"));
  EXPECT_THAT(refusal<DeviceUnready>("/no/such/node"), HasSubstr("cannot open it"));
}

TEST(ModesText, NamesWhatCanBeDecoded) {
  std::vector<CameraMode> modes{{"H264", std::nullopt, 640, 480, 30},
                                {"YUYV", PixelFormat::kYuyv, 640, 480, 30},
                                {"YUYV", PixelFormat::kYuyv, 1280, 720, 10},
                                {"Z16 ", PixelFormat::kZ16, 640, 480, 0}};
  EXPECT_EQ(modes_text(modes), "YUYV 640x480 at 30 Hz, 1280x720 at 10 Hz; Z16  640x480");
  EXPECT_EQ(modes_text({}), "nothing that Sextant can decode");
  for (int i = 0; i < 300; ++i) modes.push_back({"GREY", PixelFormat::kGrey, 1000 + i, 480, 30});
  EXPECT_LT(modes_text(modes).size(), 1000U);
}

TEST(LibcameraSource, GivesNoDepth) {
  StreamOptions options;
  options.device = "camera";
  options.depth = true;
  if (has_libcamera()) {
    EXPECT_THROW(open_libcamera_source(options), UsageError);
  } else {
    EXPECT_THROW(open_libcamera_source(options), DeviceError);
    EXPECT_TRUE(list_libcamera_devices(true).empty());
  }
}

}  // namespace
}  // namespace sextant
