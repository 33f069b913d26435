// SPDX-License-Identifier: Apache-2.0
#include "hal/libcamera/camera_system.h"

#include <fcntl.h>
#include <linux/netlink.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <thread>

#include "hal/live/stream_session.h"

namespace sextant {
namespace {

/// Counted by hand under one lock: a manager must be gone before the next one is made.
struct Shared {
  std::mutex mutex;
  int users = 0;
  bool abandoned = false;
  std::unique_ptr<libcamera::CameraManager> manager;
};

Shared& shared() {
  static Shared instance;
  return instance;
}

/// A manager that starts while udev is announcing a camera finds it and is told of it: libcamera 0.0.3 ends
/// the process because it is there twice. udev keeps this file while events wait.
bool udev_has_settled() {
  using namespace std::chrono_literals;
  const auto end = std::chrono::steady_clock::now() + 2s;
  std::error_code error;
  while (std::filesystem::exists("/run/udev/queue", error)) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(10ms);
  }
  return true;
}

int socket_option(int fd, int option) {
  int value = -1;
  socklen_t size = sizeof value;
  return ::getsockopt(fd, SOL_SOCKET, option, &value, &size) == 0 ? value : -1;
}

/// Nothing in this process hears of devices any more: an abandoned manager that is told of the camera that it
/// still holds would end the process. (libcamera is all that listens to udev here.)
void stop_listening_to_udev() {
  const int silent = ::eventfd(0, EFD_CLOEXEC);
  if (silent < 0) return;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd", error)) {
    const int fd = std::atoi(entry.path().filename().c_str());
    if (socket_option(fd, SO_DOMAIN) == AF_NETLINK &&
        socket_option(fd, SO_PROTOCOL) == NETLINK_KOBJECT_UEVENT)
      ::dup3(silent, fd, O_CLOEXEC);
  }
  ::close(silent);
}

}  // namespace

CameraSystem::CameraSystem() {
  const std::lock_guard lock(shared().mutex);
  if (shared().abandoned)
    throw DeviceUnready("libcamera", "a camera went that libcamera cannot let go of",
                        "start this program again; cameras that come and go need udev (in a container: share "
                        "/run/udev and the "
                        "host's network)");
  if (shared().users == 0) {
    if (!udev_has_settled())
      throw DeviceUnready("libcamera", "udev is still announcing devices", "it is tried again");
    // Its log goes to stderr by itself; only what is wrong, unless the user asks for more.
    ::setenv("LIBCAMERA_LOG_LEVELS", "*:ERROR", 0);
    auto manager = std::make_unique<libcamera::CameraManager>();
    if (const int error = manager->start(); error != 0)
      throw DeviceUnready("libcamera", std::string("it does not start: ") + std::strerror(-error),
                          "look at its lines above");
    shared().manager = std::move(manager);
  }
  ++shared().users;
}

CameraSystem::~CameraSystem() {
  const std::lock_guard lock(shared().mutex);
  if (--shared().users > 0 || !shared().manager) return;
  shared().manager->stop();
  shared().manager.reset();
}

void CameraSystem::abandon() {
  const std::lock_guard lock(shared().mutex);
  shared().abandoned = true;
  stop_listening_to_udev();
  // Its destructor would stop what cannot be stopped.
  [[maybe_unused]] const libcamera::CameraManager* for_ever = shared().manager.release();
}

std::vector<std::shared_ptr<libcamera::Camera>> CameraSystem::cameras() const {
  const std::lock_guard lock(shared().mutex);
  if (!shared().manager) return {};
  return shared().manager->cameras();
}

}  // namespace sextant
