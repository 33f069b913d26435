// SPDX-License-Identifier: Apache-2.0
// What systemd would hear: a datagram socket for sd_notify.
#pragma once

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstring>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace sextant {

/// Reads all the time, as systemd does: a full socket would block who speaks.
class NotifySocket {
 public:
  explicit NotifySocket(const std::string& path)
      : path_(path), socket_(socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    EXPECT_LT(path.size(), sizeof(address.sun_path));
    std::strncpy(address.sun_path, path.c_str(), sizeof(address.sun_path) - 1);
    EXPECT_EQ(bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
    const timeval wait{0, 20'000};
    setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &wait, sizeof(wait));
    thread_ = std::thread([this] {
      char buffer[4096];
      while (!stop_) {
        const ssize_t n = recv(socket_, buffer, sizeof(buffer), 0);
        const std::lock_guard lock(mutex_);
        if (n > 0) messages_.emplace_back(buffer, static_cast<std::size_t>(n));
        if (n <= 0) ++quiet_;
      }
    });
  }
  ~NotifySocket() {
    stop_ = true;
    thread_.join();
    close(socket_);
  }
  NotifySocket(const NotifySocket&) = delete;
  NotifySocket& operator=(const NotifySocket&) = delete;

  const std::string& path() const { return path_; }
  /// Everything that has come so far, one string per message.
  std::vector<std::string> messages() const {
    const int before = quiet_;
    while (quiet_ < before + 2)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));  // nothing is under way
    const std::lock_guard lock(mutex_);
    return messages_;
  }

 private:
  std::string path_;
  int socket_;
  std::atomic<bool> stop_ = false;
  std::atomic<int> quiet_ = 0;  ///< waits that ended without a message
  mutable std::mutex mutex_;
  std::vector<std::string> messages_;
  std::thread thread_;
};

}  // namespace sextant
