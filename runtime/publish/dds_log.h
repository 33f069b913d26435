// SPDX-License-Identifier: Apache-2.0
// Cyclone's own log lines into ours, at a limited rate: hostile packets can make it write without end.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

namespace sextant {

/// Passes at most `burst` events per `period`, and counts what it holds back.
class RateLimiter {
 public:
  RateLimiter(int burst, std::chrono::milliseconds period) : burst_(burst), period_(period) {}
  /// True: let this one pass; `held_back` then says how many were not since the last one that passed.
  bool pass(std::chrono::steady_clock::time_point now, std::uint64_t& held_back);

 private:
  int burst_;
  std::chrono::milliseconds period_;
  std::chrono::steady_clock::time_point window_start_{};
  int passed_ = 0;
  std::uint64_t held_back_ = 0;
};

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
