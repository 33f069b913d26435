// SPDX-License-Identifier: Apache-2.0
// Waits for a file descriptor that another thread can cut short.
#pragma once

#include <chrono>

namespace sextant {

/// An eventfd(2).
class WakeEvent {
 public:
  /// Throws DeviceError where the process may not have another file.
  WakeEvent();
  ~WakeEvent();
  WakeEvent(const WakeEvent&) = delete;
  WakeEvent& operator=(const WakeEvent&) = delete;

  void set() const;
  void clear() const;
  int fd() const { return fd_; }

  /// Waits until set, or (fd >= 0) until `fd` is readable or in error, or until the deadline. True where it
  /// was `fd`.
  bool wait(int fd, std::chrono::steady_clock::time_point deadline) const;

 private:
  int fd_ = -1;
};

}  // namespace sextant
