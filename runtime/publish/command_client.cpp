// SPDX-License-Identifier: Apache-2.0
#include "runtime/publish/command_client.h"

#include <algorithm>
#include <utility>

#include "runtime/base/error.h"
#include "runtime/publish/command_messages.h"
#include "runtime/publish/message_check.h"
#include "runtime/publish/message_text.h"
#include "runtime/publish/topic_writer.h"
#include "runtime/publish/topics.h"

namespace sextant {

namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kSendAgain{500};
constexpr std::chrono::milliseconds kSlice{20};

}  // namespace

struct CommandClient::Impl {
  WarnFunction warn;
  std::string topic;
  DdsEntity participant;
  TopicWriter commands;
  DdsEntity reader, waitset;

  /// The answer to `id` among those that came.
  std::optional<AnswerText> take(const std::string& id) {
    std::optional<AnswerText> found;
    while (!found) {
      void* sample = nullptr;
      dds_sample_info_t info{};
      if (check_dds(dds_take(reader.get(), &sample, &info, 1, 1), "cannot read " + topic) == 0) break;
      if (info.valid_data) {
        const auto& message = *static_cast<const CommandAnswerMessage*>(sample);
        try {
          check_message(message, topic);
          if (id == message.request_id) {
            found = AnswerText{static_cast<CommandResult>(message.result), printable(message.message),
                               to_text(message), to_json(message), message.look.estimates._length > 0};
          }
        } catch (const InputError& error) {
          if (warn) warn(error.what());
        }
      }
      check_dds(dds_return_loan(reader.get(), &sample, 1), "cannot return a message");
    }
    return found;
  }
};

CommandClient::CommandClient(unsigned domain, const CommandServerOptions& options, WarnFunction warn)
    : impl_(std::make_unique<Impl>()) {
  impl_->warn = std::move(warn);
  impl_->topic = dds_topic_name(options.name_space, options.answer_topic);
  impl_->participant = create_participant(domain);
  const dds_entity_t participant = impl_->participant.get();
  impl_->commands = TopicWriter(participant, dds_topic_name(options.name_space, options.command_topic),
                                topic_type<CommandMessage>(), {});
  const TopicType type = topic_type<CommandAnswerMessage>();
  QosProfile profile;  // reliable: an answer that needs several datagrams must come whole
  profile.type_hash = type.hash;
  const QosPointer qos = make_qos(profile);
  const dds_entity_t topic =
      check_dds(dds_create_topic(participant, type.descriptor, impl_->topic.c_str(), nullptr, nullptr),
                "cannot create topic " + impl_->topic);
  impl_->reader =
      DdsEntity(dds_create_reader(participant, topic, qos.get(), nullptr), "cannot read " + impl_->topic);
  impl_->waitset = DdsEntity(dds_create_waitset(participant), "cannot create a waitset");
  const dds_entity_t unread =
      check_dds(dds_create_readcondition(impl_->reader.get(), DDS_ANY_STATE), "cannot wait");
  check_dds(dds_waitset_attach(impl_->waitset.get(), unread, 0), "cannot wait");
}

CommandClient::~CommandClient() = default;

int CommandClient::matched_daemons() const {
  dds_subscription_matched_status_t status{};
  check_dds(dds_get_subscription_matched_status(impl_->reader.get(), &status), "cannot read a status");
  return std::min(static_cast<int>(status.current_count), impl_->commands.matched_readers());
}

std::optional<AnswerText> CommandClient::ask(const Command& command, std::chrono::milliseconds timeout,
                                             const std::function<bool()>& stop) {
  const CommandMessage message = to_message(command);
  const auto end = Clock::now() + timeout;
  auto send = Clock::now();
  while (Clock::now() < end && !(stop && stop())) {
    // An answer that comes before we are matched with its writer would be lost.
    if (Clock::now() >= send && matched_daemons() > 0) {
      impl_->commands.write(&message);
      send = Clock::now() + kSendAgain;
    }
    dds_attach_t triggered = 0;
    check_dds(dds_waitset_wait(impl_->waitset.get(), &triggered, 1, DDS_MSECS(kSlice.count())),
              "cannot wait");
    if (auto answer = impl_->take(command.request_id)) return answer;
  }
  return std::nullopt;
}

}  // namespace sextant
