// SPDX-License-Identifier: Apache-2.0
// libcamera allows one camera manager per process. This holds it while anybody uses it; a new one, which sees
// the devices of now, starts when nobody did.
#pragma once

#include <memory>
#include <vector>

#include "hal/libcamera/libcamera_api.h"

namespace sextant {

/// One user of the manager.
class CameraSystem {
 public:
  /// Starts the manager for the first user. Throws DeviceUnready where it does not start.
  CameraSystem();
  ~CameraSystem();
  CameraSystem(const CameraSystem&) = delete;
  CameraSystem& operator=(const CameraSystem&) = delete;

  std::vector<std::shared_ptr<libcamera::Camera>> cameras() const;
  /// Gives the manager up without ending it, for good: it holds a camera that cannot be stopped. Every
  /// further user is refused.
  void abandon();
};

}  // namespace sextant
