// SPDX-License-Identifier: Apache-2.0
#include "hal/libcamera/camera_system.h"

#include <cstdlib>
#include <cstring>
#include <mutex>

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

}  // namespace

CameraSystem::CameraSystem() {
  const std::lock_guard lock(shared().mutex);
  if (shared().abandoned)
    throw DeviceUnready(
        "libcamera", "a camera went without udev saying so, and libcamera cannot let go of it",
        "start this program again; run udev (in a container: share /run/udev and the host's network)");
  if (shared().users == 0) {
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
  // Its destructor would stop what cannot be stopped.
  [[maybe_unused]] const libcamera::CameraManager* for_ever = shared().manager.release();
}

std::vector<std::shared_ptr<libcamera::Camera>> CameraSystem::cameras() const {
  const std::lock_guard lock(shared().mutex);
  if (!shared().manager) return {};
  return shared().manager->cameras();
}

}  // namespace sextant
