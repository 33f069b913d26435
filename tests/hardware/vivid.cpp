// SPDX-License-Identifier: Apache-2.0
#include "tests/hardware/vivid.h"

#include <fcntl.h>
#include <linux/v4l2-dv-timings.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <stdexcept>

#include "hal/v4l2/v4l2_controls.h"
#include "hal/v4l2/v4l2_device.h"

namespace sextant::vivid {
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr auto kPatience = 30s;

void write_to(const char* file, const char* text) {
  std::ofstream stream(file);
  stream << text << std::flush;
  if (!stream) throw std::runtime_error(std::string(file) + ": cannot write " + text);
}

}  // namespace

StreamOptions webcam() {
  StreamOptions options;
  options.device = kWebcam;
  options.format = "YUYV";
  options.rate_hz = 25;  // its fastest in this size
  options.max_age = 0ms;
  options.watchdog = 2000ms;
  return options;
}

std::optional<RawImage> next_image(ImageSource& source) {
  const auto end = Clock::now() + kPatience;
  while (Clock::now() < end) {
    if (auto image = source.next(100ms)) return image;
  }
  return std::nullopt;
}

bool reaches(ImageSource& source, SourceState state) {
  const auto end = Clock::now() + kPatience;
  while (Clock::now() < end) {
    source.next(20ms);
    if (source.state() == state) return true;
  }
  return false;
}

void control(const std::string& node, const std::string& request) {
  set_controls(V4l2Device(node), {request}, node);
}

void unplug() { write_to("/sys/bus/platform/drivers/vivid/unbind", "vivid.0"); }
void plug() { write_to("/sys/bus/platform/drivers/vivid/bind", "vivid.0"); }

Producer::Producer(const std::string& node, std::uint32_t fourcc, int width, int height,
                   std::vector<std::vector<std::byte>> frames)
    : frames_(std::move(frames)) {
  fd_ = ::open(node.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
  if (fd_ < 0) throw std::runtime_error(node + ": " + std::strerror(errno));
  V4l2Device device(node);
  v4l2_format format{};
  format.type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
  format.fmt.pix.width = static_cast<std::uint32_t>(width);
  format.fmt.pix.height = static_cast<std::uint32_t>(height);
  format.fmt.pix.pixelformat = fourcc;
  format.fmt.pix.field = V4L2_FIELD_NONE;
  if (const int error = device.call(VIDIOC_S_FMT, &format))
    throw std::runtime_error(node + ": " + error_text(error));
  if (format.fmt.pix.sizeimage != frames_.front().size() || format.fmt.pix.pixelformat != fourcc)
    throw std::runtime_error(node + " does not take frames of this size");
  thread_ = std::jthread([this](const std::stop_token& stop) {
    for (std::size_t i = 0; !stop.stop_requested(); ++i) {
      const auto& frame = frames_[i % frames_.size()];
      pollfd polled{fd_, POLLOUT, 0};
      ::poll(&polled, 1, 100);
      if (::write(fd_, frame.data(), frame.size()) < 0 && errno != EAGAIN) std::this_thread::sleep_for(20ms);
    }
  });
}

Producer::~Producer() {
  thread_ = {};
  ::close(fd_);
}

void prepare_loop(const std::string& capture, const std::string& output) {
  for (const std::string& node : {output, capture}) {
    v4l2_dv_timings timings = V4L2_DV_BT_CEA_640X480P59_94;
    if (const int error = V4l2Device(node).call(VIDIOC_S_DV_TIMINGS, &timings))
      throw std::runtime_error(node + ": timings: " + error_text(error));
  }
}

}  // namespace sextant::vivid
