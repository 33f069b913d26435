// SPDX-License-Identifier: Apache-2.0
#include "runtime/publish/message_text.h"

#include <fmt/format.h>

#include "runtime/publish/message_check.h"

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
  std::string text =
      fmt::format("{}  frame {}: {}  ({:.3f} s, {} nodes)", text_of(message.header), message.frame_number,
                  printable(message.message), message.solve_time_s, message.nodes);
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

}  // namespace sextant
