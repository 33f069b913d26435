// SPDX-License-Identifier: Apache-2.0
// Cyclone's own log lines into ours, at a limited rate: hostile packets can make it write without end.
#pragma once

#include <functional>
#include <memory>
#include <string>

namespace sextant {

/// While it lives, Cyclone's warnings and errors go to `sink` (from any thread, one at a time), at most ten a
/// second. One per process.
class DdsLog {
 public:
  explicit DdsLog(std::function<void(const std::string&)> sink);
  ~DdsLog();
  DdsLog(const DdsLog&) = delete;
  DdsLog& operator=(const DdsLog&) = delete;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sextant
