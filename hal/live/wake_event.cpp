// SPDX-License-Identifier: Apache-2.0
#include "hal/live/wake_event.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>

#include "runtime/base/error.h"

namespace sextant {

WakeEvent::WakeEvent() : fd_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  if (fd_ < 0)
    throw DeviceError("source", std::string("no event: ") + std::strerror(errno), "close other files");
}

WakeEvent::~WakeEvent() { ::close(fd_); }

void WakeEvent::set() const {
  const std::uint64_t one = 1;
  [[maybe_unused]] const auto written = ::write(fd_, &one, sizeof one);  // full means set
}

void WakeEvent::clear() const {
  std::uint64_t count = 0;
  [[maybe_unused]] const auto got = ::read(fd_, &count, sizeof count);  // empty means clear
}

bool WakeEvent::wait(int fd, std::chrono::steady_clock::time_point deadline) const {
  std::array<pollfd, 2> polled{{{fd_, POLLIN, 0}, {fd, POLLIN, 0}}};
  for (;;) {
    const auto left = std::max(deadline - std::chrono::steady_clock::now(), std::chrono::nanoseconds::zero());
    const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(left);
    const timespec timeout{seconds.count(), static_cast<long>((left - seconds).count())};
    const int ready = ppoll(polled.data(), fd >= 0 ? 2 : 1, &timeout, nullptr);
    if (ready < 0 && errno == EINTR) continue;
    return ready > 0 && fd >= 0 && polled[1].revents != 0;
  }
}

}  // namespace sextant
