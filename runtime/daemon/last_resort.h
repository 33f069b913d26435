// SPDX-License-Identifier: Apache-2.0
// Whoever asked us to end does not wait longer than agreed, whatever hangs: a driver that does not close, a
// model that is being read.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

namespace sextant {

class LastResort {
 public:
  /// `leave` is called in another thread when this lives longer than `patience`.
  LastResort(std::chrono::milliseconds patience, std::function<void()> leave)
      : thread_([this, patience, leave = std::move(leave)] {
          std::unique_lock lock(mutex_);
          if (!ended_.wait_for(lock, patience, [this] { return over_; })) leave();
        }) {}
  ~LastResort() {
    {
      const std::lock_guard lock(mutex_);
      over_ = true;
    }
    ended_.notify_all();
    thread_.join();
  }
  LastResort(const LastResort&) = delete;
  LastResort& operator=(const LastResort&) = delete;

 private:
  std::mutex mutex_;
  std::condition_variable ended_;
  bool over_ = false;
  std::thread thread_;
};

}  // namespace sextant
