// SPDX-License-Identifier: Apache-2.0
// libcamera on the kernel's virtual camera (vimc): streams, refuses, survives that its driver goes.
#include <gmock/gmock.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <thread>

#include "hal/libcamera/libcamera_source.h"
#include "hal/pixels/decode.h"
#include "runtime/base/error.h"
#include "tests/hardware/vivid.h"

namespace sextant {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

constexpr char kDriver[] = "/sys/bus/platform/drivers/vimc";

void write_to(const std::string& file, const std::string& text) { std::ofstream(file) << text << std::flush; }

/// Waits until the system has told libcamera's enumerator of a camera: udev works beside us.
std::vector<CameraDevice> devices_in_the_end() {
  const auto end = std::chrono::steady_clock::now() + 30s;
  for (;;) {
    auto devices = list_libcamera_devices(true);
    if (!devices.empty() || std::chrono::steady_clock::now() > end) return devices;
    std::this_thread::sleep_for(100ms);
  }
}

class Libcamera : public testing::Test {
 protected:
  void SetUp() override {
    if (!has_libcamera()) GTEST_SKIP() << "this build has no libcamera";
    if (!std::filesystem::exists(kDriver)) GTEST_SKIP() << "vimc is not loaded";
    const auto devices = devices_in_the_end();
    ASSERT_FALSE(devices.empty());
    device_ = devices.front();
    options_.device = device_.id;
    options_.format = "RGB3";
    options_.width = 636;  // what the driver makes of 640
    options_.height = 480;
    options_.max_age = 0ms;
    options_.watchdog = 3000ms;
  }
  template <typename Function>
  static std::string refusal(Function function) {
    try {
      function();
    } catch (const DoorError& error) {
      return error.what();
    }
    return "no error";
  }
  CameraDevice device_;
  StreamOptions options_;
};

TEST_F(Libcamera, IsListedWithWhatItOffers) {
  EXPECT_EQ(device_.kind, "libcamera");
  EXPECT_FALSE(device_.id.empty());
  EXPECT_EQ(device_.problem, "");
  EXPECT_THAT(device_.modes, testing::Contains(testing::Field(&CameraMode::format, PixelFormat::kRgb24)));
}

TEST_F(Libcamera, Streams) {
  for (const char* format : {"RGB3", "BGR3", "auto"}) {
    options_.format = format;
    const auto source = open_libcamera_source(options_);
    std::int64_t last = -1;
    MonotonicTime last_time{};
    for (int i = 0; i < 10; ++i) {
      const auto image = vivid::next_image(*source);
      ASSERT_TRUE(image.has_value()) << format << ": " << source->condition();
      EXPECT_GT(image->sequence, last);
      EXPECT_GT(image->captured.monotonic, last_time);
      EXPECT_LE(image->captured.monotonic, std::chrono::steady_clock::now());
      last = image->sequence;
      last_time = image->captured.monotonic;
      const cv::Mat rgb = decode_colour(*image, "vimc");
      EXPECT_EQ(rgb.size(), cv::Size(636, 480));
      EXPECT_GT(cv::norm(rgb, cv::NORM_INF), 0);
    }
  }
}

TEST_F(Libcamera, LentImagesOutliveTheSource) {
  auto source = open_libcamera_source(options_);
  const auto image = vivid::next_image(*source);
  ASSERT_TRUE(image.has_value());
  source.reset();
  EXPECT_NO_THROW(decode_colour(*image, "vimc"));
}

TEST_F(Libcamera, RefusalsSayWhatThereIs) {
  options_.width = 640;
  EXPECT_THAT(refusal([&] { open_libcamera_source(options_); }), HasSubstr("636x480"));
  options_.width = 636;
  options_.format = "MJPG";
  EXPECT_THAT(refusal([&] { open_libcamera_source(options_); }), HasSubstr("it offers"));
  options_.format = "RGB3";
  options_.controls = {"Brightnezz=1"};
  EXPECT_THAT(refusal([&] { open_libcamera_source(options_); }), HasSubstr("no control 'Brightnezz'"));
  options_.controls = {"Brightness=0.25"};
  EXPECT_TRUE(vivid::next_image(*open_libcamera_source(options_)).has_value());
  options_.controls.clear();
  options_.device = "no such";
  EXPECT_THAT(refusal([&] { open_libcamera_source(options_); }), HasSubstr(device_.id));
}

// The last one: libcamera is of no use to this process afterwards. Its pipeline for vimc, unlike that for USB
// cameras, cannot let go of a camera: stopping it, and adding it again, each end the process by an assertion.
TEST_F(Libcamera, SurvivesThatItsDriverGoes) {
  const auto source = open_libcamera_source(options_);
  ASSERT_TRUE(vivid::next_image(*source).has_value());
  write_to(std::string(kDriver) + "/unbind", "vimc.0");
  EXPECT_TRUE(vivid::reaches(*source, SourceState::kWaiting)) << source->condition();
  write_to(std::string(kDriver) + "/bind", "vimc.0");
  const auto end = std::chrono::steady_clock::now() + 10s;
  while (std::chrono::steady_clock::now() < end) EXPECT_FALSE(source->next(50ms).has_value());
  EXPECT_EQ(source->state(), SourceState::kWaiting);
  EXPECT_THAT(source->condition(), HasSubstr("start this program again"));
}

}  // namespace
}  // namespace sextant
