// SPDX-License-Identifier: Apache-2.0
#include "runtime/publish/command_messages.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "runtime/publish/message_parts.h"

namespace sextant {

Command to_command(const CommandMessage& message) {
  Command command;
  command.request_id = message.request_id;
  command.kind = static_cast<CommandKind>(message.kind);
  command.object_name = message.object_name;
  command.model_file = message.model_file;
  command.value = message.value;
  std::copy(std::begin(message.region), std::end(message.region), command.region.begin());
  return command;
}

CommandMessage to_message(const Command& command) {
  CommandMessage message{};
  message.request_id = borrowed(command.request_id);
  message.kind = static_cast<std::uint8_t>(command.kind);
  message.object_name = borrowed(command.object_name);
  message.model_file = borrowed(command.model_file);
  message.value = command.value;
  std::copy(command.region.begin(), command.region.end(), message.region);
  return message;
}

AnswerBuilder::AnswerBuilder(const CommandAnswer& answer) {
  for (const ObjectState& object : answer.objects) {
    objects_.push_back({object.object_id, borrowed(object.object_name), borrowed(object.model_file),
                        object.enabled, object.threshold.value_or(std::numeric_limits<double>::quiet_NaN())});
  }
  message_.request_id = borrowed(answer.request_id);
  message_.kind = static_cast<std::uint8_t>(answer.kind);
  message_.result = static_cast<std::uint8_t>(answer.result);
  message_.message = borrowed(answer.message);
  message_.objects = borrowed_sequence<decltype(message_.objects)>(objects_);
  std::copy(answer.region.begin(), answer.region.end(), message_.region);
  message_.deadline_ms = answer.deadline_ms;
  message_.look.header.frame_id = message_.look.message = borrowed(empty_);
  if (answer.look) {
    look_ = std::make_unique<PoseEstimatesBuilder>(*answer.look, answer.look_age_s);
    message_.look = look_->message();
  }
}

}  // namespace sextant
