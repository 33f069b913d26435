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

struct CommandLoopOptions {
  /// Reads the configuration again and returns what was done in words; throws DoorError and then has changed
  /// nothing.
  std::function<std::string()> reload;
  std::chrono::milliseconds look_patience{10000};
  /// Told of every command that was answered, and how. From any thread.
  std::function<void(const Command&, const CommandAnswer&)> answered;
  /// DDS fails and the thread has ended.
  std::function<void(const std::string&)> failed;
};

class CommandLoop {
 public:
  /// All must live longer than this.
  CommandLoop(CommandServer& server, DetectionService& service, CommandLoopOptions options);
  ~CommandLoop();
  CommandLoop(const CommandLoop&) = delete;
  CommandLoop& operator=(const CommandLoop&) = delete;

 private:
  void run();
  void carry_out(const Command& command);

  CommandServer& server_;
  DetectionService& service_;
  CommandLoopOptions options_;
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

}  // namespace sextant
