// SPDX-License-Identifier: Apache-2.0
#include "runtime/publish/command_client.h"

#include <algorithm>
#include <utility>

#include "runtime/base/error.h"
#include "runtime/publish/command_messages.h"
#include "runtime/publish/message_check.h"
#include "runtime/publish/message_text.h"
#include "runtime/publish/topic_reader.h"
#include "runtime/publish/topic_writer.h"
#include "runtime/publish/topics.h"

namespace sextant {

namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kSendAgain{500};
constexpr std::chrono::milliseconds kSlice{20};
/// Damaged packets can leave a reliable reader without messages for good; after so many sends in vain it is
/// made anew.
constexpr int kNewReaderAfter = 4;

}  // namespace

struct CommandClient::Impl {
  WarnFunction warn;
  DdsEntity participant;
  TopicWriter commands;
  TopicReader answers;

  void listen(const std::string& topic) {
    // Reliable: an answer that needs several datagrams must come whole.
    answers = TopicReader(participant.get(), topic, topic_type<CommandAnswerMessage>(), {});
  }

  /// The answer to `id` among those that came.
  std::optional<AnswerText> take(const std::string& id) const {
    std::optional<AnswerText> found;
    const auto look_at = [&](const void* sample) {
      const auto& message = *static_cast<const CommandAnswerMessage*>(sample);
      try {
        check_message(message, answers.topic());
        if (id != message.request_id) return;
        found = AnswerText{static_cast<CommandResult>(message.result), printable(message.message),
                           to_text(message), to_json(message), message.look.estimates._length > 0};
      } catch (const InputError& error) {
        if (warn) warn(error.what());
      }
    };
    while (!found && answers.take(look_at)) {
    }
    return found;
  }
};

CommandClient::CommandClient(unsigned domain, const CommandServerOptions& options, WarnFunction warn)
    : impl_(std::make_unique<Impl>()) {
  impl_->warn = std::move(warn);
  impl_->participant = create_participant(domain);
  impl_->commands =
      TopicWriter(impl_->participant.get(), dds_topic_name(options.name_space, options.command_topic),
                  topic_type<CommandMessage>(), {});
  impl_->listen(dds_topic_name(options.name_space, options.answer_topic));
}

CommandClient::~CommandClient() = default;

int CommandClient::matched_daemons() const {
  return std::min(impl_->answers.matched_writers(), impl_->commands.matched_readers());
}

std::optional<AnswerText> CommandClient::ask(const Command& command, std::chrono::milliseconds timeout,
                                             const std::function<bool()>& stop) {
  const CommandMessage message = to_message(command);
  const auto end = Clock::now() + timeout;
  auto send = Clock::now();
  int in_vain = 0;
  while (Clock::now() < end && !(stop && stop())) {
    // An answer that comes before we are matched with its writer would be lost.
    if (Clock::now() >= send && matched_daemons() > 0) {
      impl_->commands.write(&message);
      send = Clock::now() + kSendAgain;
      if (++in_vain % kNewReaderAfter == 0) impl_->listen(std::string(impl_->answers.topic()));
    }
    impl_->answers.wait(kSlice);
    if (auto answer = impl_->take(command.request_id)) return answer;
  }
  return std::nullopt;
}

}  // namespace sextant
