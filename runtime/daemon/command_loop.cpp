// SPDX-License-Identifier: Apache-2.0
#include "runtime/daemon/command_loop.h"

#include <exception>
#include <utility>

#include "runtime/base/error.h"

namespace sextant {

namespace {

constexpr std::chrono::milliseconds kSlice{50};

}  // namespace

CommandLoop::CommandLoop(CommandServer& server, DetectionService& service, CommandLoopOptions options)
    : server_(server), service_(service), options_(std::move(options)), thread_([this] { run(); }) {}

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
    options_.failed(error.what());
  }
}

void CommandLoop::carry_out(const Command& command) {
  const auto answer = [this, command](const CommandAnswer& a) {
    server_.answer(a);
    if (options_.answered) options_.answered(command, a);
  };
  if (command.kind == CommandKind::kLook) return service_.look(command, answer, options_.look_patience);
  if (command.kind != CommandKind::kReload) return answer(service_.execute(command));
  try {
    answer(service_.answer_to(command, CommandResult::kDone, options_.reload()));
  } catch (const DoorError& error) {
    answer(service_.answer_to(command, CommandResult::kFailed, error.what()));
  }
}

}  // namespace sextant
