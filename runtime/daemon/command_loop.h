// SPDX-License-Identifier: Apache-2.0
// The thread that carries commands from DDS to where they are done, and their answers back.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <string>
#include <thread>

#include "runtime/daemon/detection_service.h"
#include "runtime/publish/command_server.h"

namespace sextant {

class CommandLoop {
 public:
  /// `reload` reads the configuration again and returns what was done in words; it throws DoorError and then
  /// has changed nothing. `failed` is called when DDS fails and the thread ends. All must live longer than
  /// this.
  CommandLoop(CommandServer& server, DetectionService& service, std::function<std::string()> reload,
              std::chrono::milliseconds look_patience, std::function<void(const std::string&)> failed);
  ~CommandLoop();
  CommandLoop(const CommandLoop&) = delete;
  CommandLoop& operator=(const CommandLoop&) = delete;

 private:
  void run();
  void carry_out(const Command& command);

  CommandServer& server_;
  DetectionService& service_;
  std::function<std::string()> reload_;
  std::chrono::milliseconds look_patience_;
  std::function<void(const std::string&)> failed_;
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

}  // namespace sextant
