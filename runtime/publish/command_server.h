// SPDX-License-Identifier: Apache-2.0
// Commands in, answers out. The reader is best-effort, as all our readers; who asks sends again until
// answered, and a request that comes twice is done once: its answer is sent again.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "runtime/publish/command.h"
#include "runtime/publish/publisher.h"

namespace sextant {

struct CommandServerOptions {
  std::string name_space{};
  std::string command_topic = "command";
  std::string answer_topic = "command_answer";
};

class CommandServer {
 public:
  /// `participant` as Publisher::participant gives it; it must live longer. Throws UsageError, DeviceError.
  CommandServer(std::int32_t participant, const CommandServerOptions& options, WarnFunction warn = {});
  ~CommandServer();
  CommandServer(const CommandServer&) = delete;
  CommandServer& operator=(const CommandServer&) = delete;

  /// Waits up to the timeout and returns the commands that are new and well-formed. One thread at a time.
  std::vector<Command> poll(std::chrono::milliseconds timeout);
  /// From any thread. Every command that poll returned must be answered once.
  void answer(const CommandAnswer& answer);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sextant
