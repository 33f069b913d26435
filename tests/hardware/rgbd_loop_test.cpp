// SPDX-License-Identifier: Apache-2.0
// Known RGB-D frames through two cameras: written into the virtual cameras' outputs, read through V4L2,
// decoded and paired as sextantd does. What comes out is left in $SEXTANT_HARDWARE_OUT, where
// run_hardware_test.py lets `sextant detect` find the object in it.
#include <gmock/gmock.h>

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <opencv2/core.hpp>

#include "hal/image/image_file.h"
#include "hal/sources/open_source.h"
#include "tests/hardware/vivid.h"

namespace sextant {
namespace {

using namespace std::chrono_literals;

constexpr int kWidth = 640;
constexpr int kHeight = 480;
constexpr char kSample[] = SEXTANT_SOURCE_DIR "/data/sample/test/000001/";
/// Of the sample's depth images; scene_camera.json says 0.1 mm.
constexpr double kMetresPerUnit = 0.0001;

/// BT.601, luma 16..235; the chroma of a pair is the mean of its two pixels.
std::vector<std::byte> yuyv_of(const cv::Mat& rgb) {
  std::vector<std::byte> bytes;
  bytes.reserve(static_cast<std::size_t>(kWidth) * kHeight * 2);
  const auto add = [&](double v) {
    bytes.push_back(static_cast<std::byte>(std::lround(std::clamp(v, 0.0, 255.0))));
  };
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; x += 2) {
      const cv::Vec3d a = rgb.at<cv::Vec3b>(y, x);
      const cv::Vec3d b = rgb.at<cv::Vec3b>(y, x + 1);
      const cv::Vec3d m = (a + b) / 2;
      const auto luma = [](const cv::Vec3d& p) {
        return 16 + 0.25679 * p[0] + 0.50413 * p[1] + 0.09791 * p[2];
      };
      add(luma(a));
      add(128 - 0.14822 * m[0] - 0.29099 * m[1] + 0.43922 * m[2]);
      add(luma(b));
      add(128 + 0.43922 * m[0] - 0.36779 * m[1] - 0.07143 * m[2]);
    }
  }
  return bytes;
}

std::vector<std::byte> bytes_of(const cv::Mat& depth) {
  std::vector<std::byte> bytes(depth.total() * 2);
  std::memcpy(bytes.data(), depth.data, bytes.size());
  return bytes;
}

class RgbdLoop : public testing::Test {
 protected:
  void SetUp() override {
    colour_ = read_colour_image(std::string(kSample) + "rgb/000000.png");
    depth_ = read_depth_image(std::string(kSample) + "depth/000000.png");
    ASSERT_EQ(colour_.size(), cv::Size(kWidth, kHeight));
    ASSERT_TRUE(depth_.isContinuous());
    std::ofstream("/tmp/rig.yaml")
        << "colour: {width: 640, height: 480, fx: 525, fy: 525, cx: 319.5, cy: 239.5}\n"
           "depth: {registered: true, metres_per_unit: 0.0001}\n";
    options_.kind = "v4l2";
    options_.rig = "/tmp/rig.yaml";
    options_.max_age = 0ms;  // the machine is interpreted
    options_.frame_id = "camera";
    options_.colour.device = "bus:platform:vivid-000";
    options_.colour.format = "YUYV";
    options_.depth.device = "bus:platform:vivid-001";
    options_.depth.format = "Y16";
    for (StreamOptions* stream : {&options_.colour, &options_.depth}) {
      stream->rate_hz = 0;  // that of the HDMI timings
      stream->controls = {"loop_video=1", "osd_text_mode=2"};
      stream->watchdog = 2000ms;
    }
    ASSERT_TRUE(begin());
  }

  /// False: something streams from the cameras already.
  bool begin() {
    if (!vivid::prepare_loop("/dev/video0", "/dev/video10")) return false;
    if (!vivid::prepare_loop("/dev/video1", "/dev/video11")) return false;
    const auto code = [](PixelFormat format) { return info_of(format).fourcc; };
    producers_[0] = std::make_unique<vivid::Producer>("/dev/video10", code(PixelFormat::kYuyv), kWidth,
                                                      kHeight, yuyv_of(colour_));
    producers_[1] = std::make_unique<vivid::Producer>("/dev/video11", code(PixelFormat::kY16), kWidth,
                                                      kHeight, bytes_of(depth_));
    return true;
  }

  double colour_error(const RgbdFrame& frame) const {
    cv::Mat difference;
    cv::absdiff(frame.colour, colour_, difference);
    const cv::Scalar mean = cv::mean(difference);
    return std::max({mean[0], mean[1], mean[2]});
  }
  double depth_error_m(const RgbdFrame& frame) const {
    cv::Mat wanted;
    depth_.convertTo(wanted, CV_32FC1, kMetresPerUnit);
    return cv::norm(frame.axial_depth_m, wanted, cv::NORM_INF);
  }
  bool is_the_known_frame(const RgbdFrame& frame) const {
    return colour_error(frame) < 4 && depth_error_m(frame) < 1e-6;
  }
  /// The first pairs may show what was in the loop before.
  std::optional<RgbdFrame> known_frame(FrameSource& source) {
    const auto end = std::chrono::steady_clock::now() + 30s;
    while (std::chrono::steady_clock::now() < end) {
      auto frame = source.next(100ms);
      if (!frame) continue;
      if (is_the_known_frame(*frame)) return frame;
      unlike_ = fmt::format("the last frame is off by {:.2f} levels and {:.4f} m", colour_error(*frame),
                            depth_error_m(*frame));
    }
    return std::nullopt;
  }

  SourceOptions options_;
  std::string unlike_ = "no frame came";  ///< how the last frame differs from the known one
  cv::Mat colour_;
  cv::Mat depth_;
  std::array<std::unique_ptr<vivid::Producer>, 2> producers_;
};

TEST_F(RgbdLoop, KnownFramesComeThroughAndAreLeftForDetection) {
  const auto source = open_source(options_);
  const auto first = known_frame(*source);
  ASSERT_TRUE(first.has_value()) << unlike_ << "; " << source->condition()
                                 << "; drops: " << describe_drops(source->statistics());
  std::int64_t last = first->sequence;
  MonotonicTime last_time = first->captured_monotonic;
  double latency_ms = 0;
  constexpr int kFrames = 20;
  for (int i = 0; i < kFrames; ++i) {
    std::optional<RgbdFrame> frame;
    for (int tries = 0; tries < 100 && !frame; ++tries) frame = source->next(100ms);
    ASSERT_TRUE(frame.has_value()) << source->condition();
    EXPECT_TRUE(is_the_known_frame(*frame)) << colour_error(*frame) << " " << depth_error_m(*frame);
    EXPECT_GT(frame->sequence, last);
    EXPECT_GT(frame->captured_monotonic, last_time);
    EXPECT_GT(frame->captured_at.time_since_epoch().count(), 0);
    EXPECT_EQ(frame->frame_id, "camera");
    last = frame->sequence;
    last_time = frame->captured_monotonic;
    latency_ms +=
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - last_time).count() /
        kFrames;
  }
  printf(
      "pairs: colour off by %.2f levels on average, depth by %.1g m; %.1f ms from capture to pair; drops: "
      "%s\n",
      colour_error(*first), depth_error_m(*first), latency_ms, describe_drops(source->statistics()).c_str());
  if (const char* out = std::getenv("SEXTANT_HARDWARE_OUT")) {
    cv::Mat raw;
    first->axial_depth_m.convertTo(raw, CV_16UC1, 1 / kMetresPerUnit);
    write_png(std::filesystem::path(out) / "colour.png", first->colour);
    write_png(std::filesystem::path(out) / "depth.png", raw);
  }
}

TEST_F(RgbdLoop, APairSurvivesThatBothCamerasGoAndComeBack) {
  const auto source = open_source(options_);
  ASSERT_TRUE(known_frame(*source).has_value()) << source->condition();
  producers_ = {};
  // On a busy machine the source may be the first to open what came back, and stream pictures in the driver's
  // own timings: then they go once more.
  MonotonicTime back;
  std::uint64_t times = 0;
  bool looped = false;
  while (!looped && times < 10) {
    vivid::unplug();
    const auto end = std::chrono::steady_clock::now() + 30s;
    while (source->state() != SourceState::kWaiting && std::chrono::steady_clock::now() < end)
      source->next(20ms);
    ASSERT_EQ(source->state(), SourceState::kWaiting);
    EXPECT_FALSE(source->condition().empty());
    vivid::plug();
    back = std::chrono::steady_clock::now();
    looped = begin();
    ++times;
  }
  ASSERT_TRUE(looped);
  // A pair from before may come late: the test allows any age.
  std::optional<RgbdFrame> frame;
  do {
    frame = known_frame(*source);
    ASSERT_TRUE(frame.has_value()) << unlike_ << "; " << source->condition();
  } while (frame->captured_monotonic < back);
  EXPECT_GE(source->statistics().reconnects, 2U);  // of both cameras
  EXPECT_LE(source->statistics().reconnects, 2 * times);
}

}  // namespace
}  // namespace sextant
