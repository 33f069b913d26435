// SPDX-License-Identifier: Apache-2.0
#include "hal/v4l2/v4l2_device.h"

#include <fcntl.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "hal/live/stream_session.h"

namespace sextant {

std::string error_text(int error) { return std::strerror(error); }

V4l2Device::V4l2Device(const std::string& node)
    : node_(node), fd_(::open(node.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC)) {
  if (fd_ < 0) {
    const int error = errno;
    if (error == EACCES || error == EPERM) {
      throw DeviceError(node, "no permission to open it",
                        "add the user to the group video (usermod -aG video USER, then log in again) or "
                        "install config/60-sextant-cameras.rules");
    }
    throw DeviceUnready(node, "cannot open it: " + error_text(error), "is it plugged in?");
  }
  if (call(VIDIOC_QUERYCAP, &description_) != 0) description_ = {};
}

V4l2Device::~V4l2Device() { ::close(fd_); }

int V4l2Device::call(unsigned long request, void* argument) const {
  for (;;) {
    if (::ioctl(fd_, request, argument) >= 0) return 0;
    if (errno != EINTR) return errno;
  }
}

std::uint32_t V4l2Device::capabilities() const {
  return (description_.capabilities & V4L2_CAP_DEVICE_CAPS) != 0 ? description_.device_caps
                                                                 : description_.capabilities;
}

std::uint32_t V4l2Device::capture_type() const {
  const std::uint32_t can = capabilities();
  if ((can & V4L2_CAP_STREAMING) == 0) return 0;
  if ((can & V4L2_CAP_VIDEO_CAPTURE) != 0) return V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if ((can & V4L2_CAP_VIDEO_CAPTURE_MPLANE) != 0) return V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE;
  return 0;
}

}  // namespace sextant
