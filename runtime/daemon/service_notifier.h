// SPDX-License-Identifier: Apache-2.0
// What systemd is told: ready, alive (only when frames really pass), stopping. Silent without systemd.
#pragma once

#include <chrono>
#include <string>

namespace sextant {

/// Speaks sd_notify(3) to the socket in NOTIFY_SOCKET.
class ServiceNotifier {
 public:
  ServiceNotifier();

  /// The configuration and the models are good. A camera or network that is away is waited for after this.
  void ready() const;
  /// The configuration is read again; ready() follows.
  void reloading() const;
  /// A frame passed, or the source waits for a device that is away. The watchdog lives on nothing else: when
  /// frames stop without a reason, systemd restarts the service.
  void progress();
  /// Before there is a pipeline: still trying to get at a device or the network.
  void alive() const;
  /// An orderly end begins.
  void stopping() const;
  /// One line for `systemctl status`.
  void status(const std::string& line) const;

 private:
  std::chrono::steady_clock::duration watchdog_interval_{};  ///< zero: no watchdog
  std::chrono::steady_clock::time_point last_{};
};

}  // namespace sextant
