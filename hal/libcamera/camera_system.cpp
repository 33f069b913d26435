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
  std::unique_ptr<libcamera::CameraManager> manager;
};

Shared& shared() {
  static Shared instance;
  return instance;
}

}  // namespace

CameraSystem::CameraSystem() {
  const std::lock_guard lock(shared().mutex);
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
  if (--shared().users > 0) return;
  shared().manager->stop();
  shared().manager.reset();
}

std::vector<std::shared_ptr<libcamera::Camera>> CameraSystem::cameras() const {
  const std::lock_guard lock(shared().mutex);
  return shared().manager->cameras();
}

}  // namespace sextant
