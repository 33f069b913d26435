// SPDX-License-Identifier: Apache-2.0
// What arrives over the wire is hostile until checked: numbers that are no numbers, poses that are no
// rotations, absurd sizes, text that would take over a terminal.
#pragma once

#include <string>

#include "runtime/publish/message_types.h"

namespace sextant {

/// Each throws InputError(topic, reason) for a message that nobody should act on.
void check_message(const Detection3DArrayMessage& message, const std::string& topic);
void check_message(const PoseStampedMessage& message, const std::string& topic);
void check_message(const PoseEstimateArrayMessage& message, const std::string& topic);
void check_message(const TfMessage& message, const std::string& topic);
void check_message(const MarkerArrayMessage& message, const std::string& topic);
void check_message(const ImageMessage& message, const std::string& topic);
void check_message(const TableEstimateMessage& message, const std::string& topic);
void check_message(const DiagnosticArrayMessage& message, const std::string& topic);
void check_message(const CommandMessage& message, const std::string& topic);
void check_message(const CommandAnswerMessage& message, const std::string& topic);

/// `text` with every byte that is not printable ASCII replaced by '?': fit for a terminal and for JSON.
std::string printable(const char* text);

}  // namespace sextant
