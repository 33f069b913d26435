// SPDX-License-Identifier: Apache-2.0
#include "runtime/daemon/command_loop.h"

#include <exception>
#include <utility>

#include "runtime/base/error.h"

namespace sextant {

namespace {

constexpr std::chrono::milliseconds kSlice{50};

}  // namespace

CommandLoop::CommandLoop(CommandServer& server, DetectionService& service,
                         std::function<std::string()> reload, std::chrono::milliseconds look_patience,
                         std::function<void(const std::string&)> failed)
    : server_(server),
      service_(service),
      reload_(std::move(reload)),
      look_patience_(look_patience),
      failed_(std::move(failed)),
      thread_([this] { run(); }) {}

CommandLoop::~CommandLoop() {
  stop_ = true;
  thread_.join();
}

void CommandLoop::run() {
  try {
    while (!stop_) {
      for (const Command& command : server_.poll(kSlice)) carry_out(command);
      service_.expire_looks();
    }
  } catch (const std::exception& error) {
    failed_(error.what());
  }
}

void CommandLoop::carry_out(const Command& command) {
  const auto answer = [this](const CommandAnswer& a) { server_.answer(a); };
  if (command.kind == CommandKind::kLook) return service_.look(command, answer, look_patience_);
  if (command.kind != CommandKind::kReload) return answer(service_.execute(command));
  try {
    answer(service_.answer_to(command, CommandResult::kDone, reload_()));
  } catch (const DoorError& error) {
    answer(service_.answer_to(command, CommandResult::kFailed, error.what()));
  }
}

}  // namespace sextant
