// SPDX-License-Identifier: Apache-2.0
// Asks a running daemon over DDS: what `sextant ask` does.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "runtime/publish/command.h"
#include "runtime/publish/command_server.h"

namespace sextant {

/// An answer as it came over the wire.
struct AnswerText {
  CommandResult result = CommandResult::kDone;
  std::string message;
  std::string text;    ///< for people, several lines
  std::string json;    ///< for programs, one line
  bool found = false;  ///< the answer of a look holds a pose
};

class CommandClient {
 public:
  /// Throws UsageError, DeviceError.
  CommandClient(unsigned domain, const CommandServerOptions& options, WarnFunction warn = {});
  ~CommandClient();
  CommandClient(const CommandClient&) = delete;
  CommandClient& operator=(const CommandClient&) = delete;

  /// Sends the command, again twice a second, until its answer comes; nothing after the timeout or when
  /// `stop` says so.
  std::optional<AnswerText> ask(const Command& command, std::chrono::milliseconds timeout,
                                const std::function<bool()>& stop = {});
  /// Daemons that answer here at this moment.
  int matched_daemons() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sextant
