// SPDX-License-Identifier: Apache-2.0
#include "runtime/publish/message_text.h"

#include <fmt/format.h>

#include <cmath>

#include "runtime/publish/command.h"
#include "runtime/publish/message_check.h"
#include "runtime/refine/frame_result.h"

namespace sextant {

namespace {

std::string text_of(const std_msgs_msg_dds__Header_& header) {
  return fmt::format("{}.{:09} {}", header.stamp.sec, header.stamp.nanosec, printable(header.frame_id));
}

std::string text_of(const geometry_msgs_msg_dds__Pose_& pose) {
  return fmt::format("t [{:.4f} {:.4f} {:.4f}] m  q [{:.4f} {:.4f} {:.4f} {:.4f}]", pose.position.x,
                     pose.position.y, pose.position.z, pose.orientation.x, pose.orientation.y,
                     pose.orientation.z, pose.orientation.w);
}

const char* text_of_status(std::uint8_t status) { return to_string(static_cast<SearchStatus>(status)); }

}  // namespace

std::string to_text(const Detection3DArrayMessage& message) {
  std::string text = fmt::format("{}  {} detection{}", text_of(message.header), message.detections._length,
                                 message.detections._length == 1 ? "" : "s");
  for (std::uint32_t i = 0; i < message.detections._length; ++i) {
    const auto& detection = message.detections._buffer[i];
    for (std::uint32_t j = 0; j < detection.results._length; ++j) {
      const auto& result = detection.results._buffer[j];
      text += fmt::format("\n  {} ({}): score {:.3f}  {}", printable(result.hypothesis.class_id),
                          printable(detection.id), result.hypothesis.score, text_of(result.pose.pose));
    }
  }
  return text;
}

std::string to_text(const PoseStampedMessage& message) {
  return text_of(message.header) + "  " + text_of(message.pose);
}

std::string to_text(const PoseEstimateArrayMessage& message) {
  std::string text = fmt::format("{}  frame {}: {}  ({:.3f} s, {} nodes, age {:.3f} s)",
                                 text_of(message.header), message.frame_number, printable(message.message),
                                 message.solve_time_s, message.nodes, message.age_s);
  for (std::uint32_t i = 0; i < message.estimates._length; ++i) {
    const auto& e = message.estimates._buffer[i];
    text += fmt::format("\n  {} ({}): {}, score {:.3f}, log score {:.4f}, bound {:.4f}, gap {:.4f}\n    {}",
                        printable(e.object_name), e.object_id, text_of_status(e.status), e.score, e.log_score,
                        e.upper_bound, e.gap, text_of(e.pose.pose));
  }
  for (std::uint32_t i = 0; i < message.objects._length; ++i) {
    const auto& object = message.objects._buffer[i];
    text += fmt::format("\n  object {} ({}): {}, bound {:.4f}, threshold {:.4g}, coverage {:.3f}",
                        printable(object.object_name), object.object_id, text_of_status(object.status),
                        object.upper_bound, object.threshold, object.coverage);
  }
  return text;
}

std::string to_text(const TfMessage& message) {
  std::string text =
      fmt::format("{} transform{}", message.transforms._length, message.transforms._length == 1 ? "" : "s");
  for (std::uint32_t i = 0; i < message.transforms._length; ++i) {
    const auto& t = message.transforms._buffer[i];
    const auto& at = t.transform.translation;
    text += fmt::format("\n  {} -> {}  {}", text_of(t.header), printable(t.child_frame_id),
                        text_of(geometry_msgs_msg_dds__Pose_{{at.x, at.y, at.z}, t.transform.rotation}));
  }
  return text;
}

std::string to_text(const MarkerArrayMessage& message) {
  std::string text =
      fmt::format("{} marker{}", message.markers._length, message.markers._length == 1 ? "" : "s");
  for (std::uint32_t i = 0; i < message.markers._length; ++i) {
    const auto& m = message.markers._buffer[i];
    text += fmt::format("\n  {} {} {}: type {}, action {}, {} points {}", text_of(m.header), printable(m.ns),
                        m.id, m.type, m.action, m.points._length, printable(m.text));
  }
  return text;
}

std::string to_text(const ImageMessage& message) {
  return fmt::format("{}  {} x {} {}, {} bytes", text_of(message.header), message.width, message.height,
                     printable(message.encoding), message.data._length);
}

std::string to_text(const TableEstimateMessage& message) {
  const auto& up = message.up_in_camera;
  constexpr double kDegrees = 57.29577951308232;
  return fmt::format(
      "{}  camera {:.4f} m above the table, pitch {:.2f} deg, roll {:.2f} deg, up [{:.4f} {:.4f} {:.4f}]",
      text_of(message.header), message.camera_height_m, message.pitch_rad * kDegrees,
      message.roll_rad * kDegrees, up.x, up.y, up.z);
}

std::string to_text(const DiagnosticArrayMessage& message) {
  static constexpr const char* kLevels[] = {"OK", "WARN", "ERROR", "STALE"};
  std::string text = fmt::format("{}.{:09}", message.header.stamp.sec, message.header.stamp.nanosec);
  for (std::uint32_t i = 0; i < message.status._length; ++i) {
    const auto& s = message.status._buffer[i];
    text += fmt::format("\n  {} {}: {}", s.level < 4 ? kLevels[s.level] : "?", printable(s.name),
                        printable(s.message));
    for (std::uint32_t j = 0; j < s.values._length; ++j) {
      text += fmt::format("\n    {}: {}", printable(s.values._buffer[j].key),
                          printable(s.values._buffer[j].value));
    }
  }
  return text;
}

std::string to_text(const CommandMessage& message) {
  const auto& r = message.region;
  return fmt::format("{} ({}): object '{}', model '{}', value {}, region {} {} {} {}",
                     to_string(static_cast<CommandKind>(message.kind)), printable(message.request_id),
                     printable(message.object_name), printable(message.model_file), message.value, r[0], r[1],
                     r[2], r[3]);
}

std::string to_text(const CommandAnswerMessage& message) {
  static constexpr const char* kResults[] = {"done", "refused", "failed"};
  std::string text =
      fmt::format("{}: {}", message.result < 3 ? kResults[message.result] : "?", printable(message.message));
  for (std::uint32_t i = 0; i < message.objects._length; ++i) {
    const auto& o = message.objects._buffer[i];
    text += fmt::format("\n  {} ({}): {}, threshold {}, {}", printable(o.object_name), o.object_id,
                        o.enabled ? "enabled" : "disabled",
                        std::isnan(o.threshold) ? "auto" : fmt::format("{:.4g}", o.threshold),
                        printable(o.model_file));
  }
  const auto& r = message.region;
  text +=
      r[2] == 0 ? "\n  region: whole image" : fmt::format("\n  region: {} {} {} {}", r[0], r[1], r[2], r[3]);
  text += message.deadline_ms > 0 ? fmt::format("\n  deadline: {:.4g} ms", message.deadline_ms)
                                  : "\n  deadline: none";
  if (message.look.header.stamp.sec != 0) text.append("\n").append(to_text(message.look));
  return text;
}

}  // namespace sextant
