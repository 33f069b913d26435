// SPDX-License-Identifier: Apache-2.0
// Messages for people (a few lines of text) and for programs (one line of JSON). Check them first.
#pragma once

#include <string>

#include "runtime/publish/message_types.h"

namespace sextant {

std::string to_text(const Detection3DArrayMessage& message);
std::string to_text(const PoseStampedMessage& message);
std::string to_text(const PoseEstimateArrayMessage& message);
std::string to_text(const TfMessage& message);
std::string to_text(const MarkerArrayMessage& message);
std::string to_text(const ImageMessage& message);
std::string to_text(const TableEstimateMessage& message);
std::string to_text(const DiagnosticArrayMessage& message);
std::string to_text(const CommandMessage& message);
std::string to_text(const CommandAnswerMessage& message);

/// Field names as in the .msg files; numbers as they came, infinities as null; poses additionally as
/// "camera_from_object", 4x4 row-major, metres; of images all but the pixels, of markers the number of
/// points.
std::string to_json(const Detection3DArrayMessage& message);
std::string to_json(const PoseStampedMessage& message);
std::string to_json(const PoseEstimateArrayMessage& message);
std::string to_json(const TfMessage& message);
std::string to_json(const MarkerArrayMessage& message);
std::string to_json(const ImageMessage& message);
std::string to_json(const TableEstimateMessage& message);
std::string to_json(const DiagnosticArrayMessage& message);
std::string to_json(const CommandMessage& message);
std::string to_json(const CommandAnswerMessage& message);

}  // namespace sextant
