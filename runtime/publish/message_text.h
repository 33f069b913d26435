// SPDX-License-Identifier: Apache-2.0
// Messages for people (a few lines of text) and for programs (one line of JSON). Check them first.
#pragma once

#include <string>

#include "runtime/publish/message_builder.h"

namespace sextant {

std::string to_text(const Detection3DArrayMessage& message);
std::string to_text(const PoseStampedMessage& message);
std::string to_text(const PoseEstimateArrayMessage& message);

/// Field names as in the .msg files; numbers as they came, infinities as null; poses additionally as
/// "camera_from_object", 4x4 row-major, metres.
std::string to_json(const Detection3DArrayMessage& message);
std::string to_json(const PoseStampedMessage& message);
std::string to_json(const PoseEstimateArrayMessage& message);

}  // namespace sextant
