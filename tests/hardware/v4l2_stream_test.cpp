// SPDX-License-Identifier: Apache-2.0
// Streams of the kernel's virtual cameras: identities, formats against the driver's own pictures, controls,
// buffers, refusals.
#include <gmock/gmock.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <opencv2/core.hpp>
#include <thread>

#include "hal/pixels/decode.h"
#include "hal/v4l2/v4l2_controls.h"
#include "hal/v4l2/v4l2_source.h"
#include "runtime/base/error.h"
#include "tests/hardware/vivid.h"

namespace sextant {
namespace {

using namespace std::chrono_literals;
using testing::Contains;
using testing::Field;
using testing::HasSubstr;
using vivid::next_image;

/// What an error says.
template <typename Function>
std::string refusal(Function function) {
  try {
    function();
  } catch (const DoorError& error) {
    return error.what();
  }
  return "no error";
}

TEST(V4l2Devices, AreListedByStableIdentity) {
  const std::vector<CameraDevice> devices = list_v4l2_devices(true);
  ASSERT_THAT(devices, testing::SizeIs(4));  // the outputs are no cameras
  const CameraDevice& webcam = devices[2];
  EXPECT_EQ(webcam.id, vivid::kWebcam);
  EXPECT_THAT(webcam.aliases, Contains("/dev/video2"));
  EXPECT_EQ(webcam.driver, "vivid");
  EXPECT_EQ(webcam.name, "vivid");
  EXPECT_EQ(webcam.problem, "");
  for (const char* fourcc : {"YUYV", "UYVY", "NV12", "RGB3", "BGR3", "GREY", "Y16 ", "Y12 ", "Y10 "})
    EXPECT_THAT(webcam.modes,
                Contains(testing::AllOf(Field(&CameraMode::fourcc, fourcc), Field(&CameraMode::width, 640),
                                        Field(&CameraMode::height, 480),
                                        Field(&CameraMode::max_rate_hz, testing::Ge(25)))));
  EXPECT_THAT(webcam.controls, Contains(Field(&CameraControl::name, "brightness")));
}

TEST(V4l2Devices, OpenByEveryName) {
  std::filesystem::create_directories("/dev/v4l/by-id");
  std::filesystem::create_symlink("../../video2", "/dev/v4l/by-id/usb-Maker_Camera_42-video-index0");
  const std::string id = list_v4l2_devices(false)[2].id;
  EXPECT_EQ(id, "usb-Maker_Camera_42-video-index0");
  for (const std::string& name : {id, "/dev/v4l/by-id/" + id, std::string(vivid::kWebcam),
                                  std::string(vivid::kWebcam) + "#0", std::string("/dev/video2")}) {
    const auto device = open_v4l2_device(name);
    EXPECT_STREQ(reinterpret_cast<const char*>(device->description().bus_info), "platform:vivid-002") << name;
  }
  std::filesystem::remove_all("/dev/v4l");
  EXPECT_THAT(refusal([] { open_v4l2_device("serial:none"); }),
              HasSubstr("there are bus:platform:vivid-000"));
  EXPECT_THAT(refusal([] { open_v4l2_device("/dev/video10"); }), HasSubstr("no camera that streams"));
  EXPECT_THAT(refusal([] { open_v4l2_device("/dev/null"); }), HasSubstr("no camera that streams"));
  EXPECT_THAT(refusal([] { open_v4l2_device("/dev/video77"); }), HasSubstr("cannot open it"));
}

TEST(V4l2Devices, WithoutPermissionTheyAreListedWithTheReason) {
  const pid_t child = fork();
  if (child == 0) {
    if (setgid(65534) != 0 || setuid(65534) != 0) _exit(2);
    const auto devices = list_v4l2_devices(true);
    const bool good = devices.size() == 6 && devices[0].problem.find("group video") != std::string::npos;
    _exit(good ? 0 : 1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
}

/// The driver draws its test pattern in each format by its own conversion.
class V4l2Colour : public testing::TestWithParam<const char*> {};

TEST_P(V4l2Colour, DecodesToTheDriversPattern) {
  StreamOptions options = vivid::webcam();
  options.controls = {"osd_text_mode=2", "test_pattern=1"};  // 100 % colour bars, nothing written over them
  options.format = GetParam();
  const auto source = open_v4l2_source(options);
  const auto image = next_image(*source);
  ASSERT_TRUE(image.has_value()) << source->condition();
  const cv::Mat rgb = decode_colour(*image, "vivid");
  ASSERT_EQ(rgb.size(), cv::Size(640, 480));
  // white, yellow, cyan, green, magenta, red, blue, black
  const std::vector<cv::Vec3b> bars{{255, 255, 255}, {255, 255, 0}, {0, 255, 255}, {0, 255, 0},
                                    {255, 0, 255},   {255, 0, 0},   {0, 0, 255},   {0, 0, 0}};
  const bool grey = std::string(GetParam()) == "GREY";
  for (std::size_t i = 0; i < bars.size(); ++i) {
    const auto pixel = rgb.at<cv::Vec3b>(240, static_cast<int>(80 * i + 40));
    // The driver's grey is the luma of Rec. 709, its YUV that of BT.601.
    const double luma = 0.2126 * bars[i][0] + 0.7152 * bars[i][1] + 0.0722 * bars[i][2];
    for (int channel = 0; channel < 3; ++channel) {
      const double wanted = grey ? luma : bars[i][channel];
      EXPECT_NEAR(pixel[channel], wanted, 8) << GetParam() << " bar " << i << " channel " << channel;
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Formats, V4l2Colour,
                         testing::Values("YUYV", "UYVY", "NV12", "RGB3", "BGR3", "GREY"));

TEST(V4l2Stream, MultiPlanarNodesWorkAlike) {
  for (const char* format : {"YUYV", "NV12", "Y16"}) {
    StreamOptions options = vivid::webcam();
    options.device = vivid::kPlanarWebcam;
    options.format = format;
    options.depth = std::string(format) == "Y16";
    const auto source = open_v4l2_source(options);
    const auto image = next_image(*source);
    ASSERT_TRUE(image.has_value()) << source->condition();
    EXPECT_NO_THROW(options.depth ? decode_values(*image, "vivid") : decode_colour(*image, "vivid"));
  }
}

TEST(V4l2Stream, AutoTakesTheFirstThatFits) {
  StreamOptions options = vivid::webcam();
  options.format = "auto";
  EXPECT_EQ(next_image(*open_v4l2_source(options))->format, PixelFormat::kYuyv);
  options.depth = true;
  EXPECT_EQ(next_image(*open_v4l2_source(options))->format, PixelFormat::kY16);
}

TEST(V4l2Stream, RefusalsSayWhatThereIs) {
  StreamOptions options = vivid::webcam();
  options.format = "MJPG";
  EXPECT_THAT(refusal([&] { open_v4l2_source(options); }),
              testing::AllOf(HasSubstr("does not offer MJPG 640x480"), HasSubstr("YUYV 320x180")));
  options.format = "YUYV";
  options.width = 644;
  EXPECT_THAT(refusal([&] { open_v4l2_source(options); }), HasSubstr("it gives YUYV 640x480"));
  options.width = 640;
  options.rate_hz = 500;
  EXPECT_THAT(refusal([&] { open_v4l2_source(options); }), HasSubstr("Hz"));
  options.rate_hz = 25;
  options.controls = {"sharpnezz=3"};
  EXPECT_THAT(refusal([&] { open_v4l2_source(options); }),
              testing::AllOf(HasSubstr("no control 'sharpnezz'"), HasSubstr("brightness")));
  options.controls = {"brightness=300"};
  EXPECT_THAT(refusal([&] { open_v4l2_source(options); }), HasSubstr("use 0 to 255"));
  const auto first = open_v4l2_source(vivid::webcam());
  EXPECT_THAT(refusal([&] { open_v4l2_source(vivid::webcam()); }), HasSubstr("another program"));
}

TEST(V4l2Stream, ControlsAreSetBeforeStreaming) {
  StreamOptions options = vivid::webcam();
  options.controls = {"brightness=77", "gain, automatic=false", "test_pattern=100% Black"};
  const auto source = open_v4l2_source(options);
  ASSERT_TRUE(next_image(*source).has_value());
  for (const CameraControl& control : list_controls(V4l2Device(vivid::kWebcamNode))) {
    if (control.name == "test_pattern") {
      EXPECT_EQ(control.menu.at(static_cast<std::size_t>(*control.value)), "100% Black");
    } else if (control.name == "brightness" || control.name == "gain_automatic") {
      EXPECT_EQ(control.value, control.name == "brightness" ? 77 : 0);
    }
  }
  for (const char* standard : {"test_pattern=0", "brightness=128", "gain_automatic=1"})
    vivid::control(vivid::kWebcamNode, standard);
}

TEST(V4l2Stream, LentBuffersAreTheDriversOwn) {
  StreamOptions options = vivid::webcam();
  options.export_dma_buf = true;
  options.newest_only = false;
  const auto source = open_v4l2_source(options);
  std::vector<RawImage> held;
  for (int i = 0; i < 4; ++i) {
    auto image = next_image(*source);
    ASSERT_TRUE(image.has_value());
    held.push_back(std::move(*image));
  }
  for (const RawImage& image : held) {
    ASSERT_GE(image.dma_buf_fd, 0);
    void* shared = mmap(nullptr, image.bytes.size(), PROT_READ, MAP_SHARED, image.dma_buf_fd, 0);
    ASSERT_NE(shared, MAP_FAILED);
    EXPECT_EQ(std::memcmp(shared, image.bytes.data(), image.bytes.size()), 0);
    munmap(shared, image.bytes.size());
  }
  // Everything is lent: silence, which is nobody's fault, however long.
  const auto until = std::chrono::steady_clock::now() + options.watchdog + 500ms;
  while (std::chrono::steady_clock::now() < until) EXPECT_FALSE(source->next(100ms).has_value());
  EXPECT_EQ(source->state(), SourceState::kRunning);
  // Given back by another thread.
  std::thread([&] { held.clear(); }).join();
  EXPECT_TRUE(next_image(*source).has_value());
  EXPECT_EQ(source->statistics().reconnects, 0U);
}

TEST(V4l2Stream, ALentBufferOutlivesItsSource) {
  auto source = open_v4l2_source(vivid::webcam());
  const auto image = next_image(*source);
  const cv::Mat before = decode_colour(*image, "vivid");
  source.reset();
  const cv::Mat after = decode_colour(*image, "vivid");
  EXPECT_EQ(cv::norm(before, after, cv::NORM_INF), 0);
}

TEST(V4l2Stream, CloseEndsAWait) {
  const auto source = open_v4l2_source(vivid::webcam());
  ASSERT_TRUE(next_image(*source).has_value());
  vivid::control(vivid::kWebcamNode, "percentage_of_dropped_buffers=100");
  std::thread closer([&] {
    std::this_thread::sleep_for(200ms);
    source->close();
  });
  while (source->state() != SourceState::kEnded) source->next(60s);
  closer.join();
  vivid::control(vivid::kWebcamNode, "percentage_of_dropped_buffers=0");
}

}  // namespace
}  // namespace sextant
