// SPDX-License-Identifier: Apache-2.0
#include "tests/hardware/vivid.h"

#include <linux/v4l2-dv-timings.h>
#include <poll.h>
#include <sys/mman.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <thread>

#include "hal/v4l2/v4l2_controls.h"

namespace sextant::vivid {
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr auto kPatience = 30s;
constexpr std::uint32_t kBuffers = 3;

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
                   std::vector<std::byte> frame)
    : frame_(std::move(frame)), device_(node) {
  v4l2_format format{};
  format.type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
  format.fmt.pix.width = static_cast<std::uint32_t>(width);
  format.fmt.pix.height = static_cast<std::uint32_t>(height);
  format.fmt.pix.pixelformat = fourcc;
  format.fmt.pix.field = V4L2_FIELD_NONE;
  must(VIDIOC_S_FMT, &format, "format");
  if (format.fmt.pix.sizeimage != frame_.size() || format.fmt.pix.pixelformat != fourcc)
    throw std::runtime_error(node + " does not take frames of this size");
  v4l2_requestbuffers request{};
  request.count = kBuffers;
  request.type = format.type;
  request.memory = V4L2_MEMORY_MMAP;
  must(VIDIOC_REQBUFS, &request, "buffers");
  for (std::uint32_t i = 0; i < request.count; ++i) {
    v4l2_buffer buffer = buffer_of(i);
    must(VIDIOC_QUERYBUF, &buffer, "buffer");
    void* data = mmap(nullptr, buffer.length, PROT_READ | PROT_WRITE, MAP_SHARED, device_.fd(),
                      static_cast<off_t>(buffer.m.offset));
    if (data == MAP_FAILED) throw std::runtime_error(node + ": mmap: " + error_text(errno));
    std::memcpy(data, frame_.data(), frame_.size());
    munmap(data, buffer.length);
    queue(i);
  }
  auto type = static_cast<int>(format.type);
  must(VIDIOC_STREAMON, &type, "stream on");
  thread_ = std::jthread([this](const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      pollfd polled{device_.fd(), POLLOUT, 0};
      v4l2_buffer buffer = buffer_of(0);
      if (::poll(&polled, 1, 100) > 0 && device_.call(VIDIOC_DQBUF, &buffer) == 0) queue(buffer.index);
    }
  });
}

v4l2_buffer Producer::buffer_of(std::uint32_t index) const {
  v4l2_buffer buffer{};
  buffer.index = index;
  buffer.type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
  buffer.memory = V4L2_MEMORY_MMAP;
  buffer.field = V4L2_FIELD_NONE;
  buffer.bytesused = static_cast<std::uint32_t>(frame_.size());
  return buffer;
}

void Producer::must(unsigned long request, void* argument, const char* what) const {
  if (const int error = device_.call(request, argument))
    throw std::runtime_error(device_.node() + ": " + what + ": " + error_text(error));
}

void Producer::queue(std::uint32_t index) const {
  v4l2_buffer buffer = buffer_of(index);
  must(VIDIOC_QBUF, &buffer, "queue");
}

bool prepare_loop(const std::string& capture, const std::string& output) {
  for (const std::string& node : {output, capture}) {
    // A source that waits for the device may have opened it before us, and lets go of it again.
    int error = EBUSY;
    for (int i = 0; i < 100 && error == EBUSY; ++i) {
      v4l2_dv_timings timings = V4L2_DV_BT_CEA_640X480P59_94;
      error = V4l2Device(node).call(VIDIOC_S_DV_TIMINGS, &timings);
      if (error == EBUSY) std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    if (error == EBUSY) return false;
    if (error != 0) throw std::runtime_error(node + ": timings: " + error_text(error));
  }
  return true;
}

}  // namespace sextant::vivid
