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
  std::string topic;
  TopicWriter answers;
  DdsEntity reader, waitset;
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
  impl_->topic = dds_topic_name(options.name_space, options.command_topic);
  QosProfile reliable;
  reliable.depth = kHistory;
  impl_->answers = TopicWriter(participant, dds_topic_name(options.name_space, options.answer_topic),
                               topic_type<CommandAnswerMessage>(), reliable);
  QosProfile profile;
  profile.reliable = false;
  profile.depth = kHistory;
  const TopicType type = topic_type<CommandMessage>();
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

CommandServer::~CommandServer() = default;

std::vector<Command> CommandServer::poll(std::chrono::milliseconds timeout) {
  dds_attach_t triggered = 0;
  check_dds(dds_waitset_wait(impl_->waitset.get(), &triggered, 1, DDS_MSECS(timeout.count())), "cannot wait");
  std::vector<Command> commands;
  for (int i = 0; i < kMostAtOnce; ++i) {
    void* sample = nullptr;
    dds_sample_info_t info{};
    if (check_dds(dds_take(impl_->reader.get(), &sample, &info, 1, 1), "cannot read " + impl_->topic) == 0)
      break;
    std::optional<Command> command;
    if (info.valid_data) {
      const auto& message = *static_cast<const CommandMessage*>(sample);
      try {
        check_message(message, impl_->topic);
        command = to_command(message);
      } catch (const InputError& error) {
        if (impl_->warn) impl_->warn(error.what());
      }
    }
    check_dds(dds_return_loan(impl_->reader.get(), &sample, 1), "cannot return a message");
    if (command && impl_->is_new(command->request_id)) commands.push_back(std::move(*command));
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
