// SPDX-License-Identifier: Apache-2.0
// Commands and answers between their plain form (command.h) and the wire.
#pragma once

#include <memory>
#include <vector>

#include "runtime/publish/command.h"
#include "runtime/publish/message_builder.h"
#include "runtime/publish/message_types.h"

namespace sextant {

/// Of a message that passed check_message; a kind that nobody knows stays what it is.
Command to_command(const CommandMessage& message);
/// Points into the command.
CommandMessage to_message(const Command& command);

/// Points into the answer, which must outlive the write.
class AnswerBuilder {
 public:
  explicit AnswerBuilder(const CommandAnswer& answer);
  const CommandAnswerMessage& message() const { return message_; }

 private:
  std::string empty_;
  std::vector<sextant_msgs_msg_dds__ObjectState_> objects_;
  std::unique_ptr<PoseEstimatesBuilder> look_;
  CommandAnswerMessage message_{};
};

}  // namespace sextant
