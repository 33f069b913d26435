// SPDX-License-Identifier: Apache-2.0
#include "runtime/publish/command_server.h"

#include <algorithm>
#include <deque>
#include <mutex>
#include <optional>
#include <utility>

#include "runtime/base/error.h"
#include "runtime/publish/command_messages.h"
#include "runtime/publish/message_check.h"
#include "runtime/publish/topic_reader.h"
#include "runtime/publish/topic_writer.h"
#include "runtime/publish/topics.h"

namespace sextant {

namespace {

constexpr int kHistory = 32;
/// Requests that are remembered, so that one that is sent again is not done again.
constexpr std::size_t kRemembered = 256;
/// At most so many in one round: a flood must not keep the thread from ending.
constexpr int kMostAtOnce = 32;

}  // namespace

struct CommandServer::Impl {
  struct Request {
    std::string id;
    std::optional<CommandAnswer> answer;
  };

  WarnFunction warn;
  TopicWriter answers;
  TopicReader commands;
  std::mutex mutex;  // guards `requests`
  std::deque<Request> requests;

  void write(const CommandAnswer& answer) {
    const AnswerBuilder builder(answer);
    if (!answers.write(&builder.message()) && warn) warn(answers.topic() + ": an answer is lost");
  }

  /// True for a request that was not seen before; a known one is answered again.
  bool is_new(const std::string& id) {
    std::optional<CommandAnswer> again;
    {
      const std::lock_guard lock(mutex);
      const auto known =
          std::find_if(requests.begin(), requests.end(), [&](const Request& r) { return r.id == id; });
      if (known == requests.end()) {
        requests.push_back({id, std::nullopt});
        if (requests.size() > kRemembered) requests.pop_front();
        return true;
      }
      again = known->answer;
    }
    if (again) write(*again);
    return false;
  }
};

CommandServer::CommandServer(std::int32_t participant, const CommandServerOptions& options, WarnFunction warn)
    : impl_(std::make_unique<Impl>()) {
  impl_->warn = std::move(warn);
  QosProfile profile;
  profile.depth = kHistory;
  impl_->answers = TopicWriter(participant, dds_topic_name(options.name_space, options.answer_topic),
                               topic_type<CommandAnswerMessage>(), profile);
  profile.reliable = false;
  impl_->commands = TopicReader(participant, dds_topic_name(options.name_space, options.command_topic),
                                topic_type<CommandMessage>(), profile);
}

CommandServer::~CommandServer() = default;

std::vector<Command> CommandServer::poll(std::chrono::milliseconds timeout) {
  impl_->commands.wait(timeout);
  std::vector<Command> commands;
  const auto look_at = [&](const void* sample) {
    const auto& message = *static_cast<const CommandMessage*>(sample);
    try {
      check_message(message, impl_->commands.topic());
      Command command = to_command(message);
      if (impl_->is_new(command.request_id)) commands.push_back(std::move(command));
    } catch (const InputError& error) {
      if (impl_->warn) impl_->warn(error.what());
    }
  };
  for (int i = 0; i < kMostAtOnce && impl_->commands.take(look_at); ++i) {
  }
  return commands;
}

void CommandServer::answer(const CommandAnswer& answer) {
  {
    const std::lock_guard lock(impl_->mutex);
    for (Impl::Request& request : impl_->requests) {
      if (request.id == answer.request_id) request.answer = answer;
    }
  }
  impl_->write(answer);
}

}  // namespace sextant
