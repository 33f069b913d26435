// SPDX-License-Identifier: Apache-2.0
// What a running daemon can be asked, and how it answers (idl/msg/sextant_msgs/msg/Command.msg), without DDS.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "runtime/refine/frame_result.h"

namespace sextant {

/// Values of Command.kind.
enum class CommandKind : std::uint8_t {
  kStatus = 0,
  kLoad = 1,
  kUnload = 2,
  kEnable = 3,
  kDisable = 4,
  kRegion = 5,
  kThreshold = 6,
  kDeadline = 7,
  kLook = 8,
  kReload = 9,
};

/// As `sextant ask` spells it, e.g. "look"; "kind 17" for one that nobody knows.
std::string to_string(CommandKind kind);

/// x, y, width, height in pixels of the source image; all zero: the whole image.
using ImageRegion = std::array<std::uint32_t, 4>;

struct Command {
  std::string request_id;
  CommandKind kind = CommandKind::kStatus;
  std::string object_name{};
  std::string model_file{};
  double value = std::numeric_limits<double>::quiet_NaN();
  ImageRegion region{};
};

/// Values of CommandAnswer.result.
enum class CommandResult : std::uint8_t {
  kDone = 0,
  kRefused = 1,  ///< it makes no sense; nothing has changed
  kFailed = 2,   ///< it was tried and did not work; nothing has changed
};

/// One loaded model.
struct ObjectState {
  int object_id = 0;
  std::string object_name;
  std::string model_file;
  bool enabled = true;
  std::optional<double> threshold;  ///< empty: what the detector takes
};

struct CommandAnswer {
  std::string request_id;
  CommandKind kind = CommandKind::kStatus;
  CommandResult result = CommandResult::kDone;
  std::string message;
  std::vector<ObjectState> objects{};
  ImageRegion region{};
  double deadline_ms = 0;
  std::optional<FrameResult> look{};  ///< of kLook
  double look_age_s = 0;              ///< from its capture to the answer
};

}  // namespace sextant
