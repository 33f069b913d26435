// SPDX-License-Identifier: Apache-2.0
// FrameResult -> the messages of idl/. Strings point into the FrameResult and arrays into the builder, so
// that a write serialises once and copies nothing before: both must outlive the write.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "idl/dds/sextant_msgs.h"
#include "idl/dds/vision_msgs.h"
#include "runtime/publish/publisher.h"
#include "runtime/refine/frame_result.h"

namespace sextant {

using Detection3DArrayMessage = vision_msgs_msg_dds__Detection3DArray_;
using PoseStampedMessage = geometry_msgs_msg_dds__PoseStamped_;
using PoseEstimateArrayMessage = sextant_msgs_msg_dds__PoseEstimateArray_;

/// Throws std::logic_error for a result that must not leave the process: no capture stamp (or one that ROS
/// cannot say, before 1970 or after 2038), a pose that is not finite or not a rotation, a score outside 0..1.
void check_publishable(const FrameResult& result);

/// One message per estimate with its 3D box, in the order of the result.
class DetectionsBuilder {
 public:
  DetectionsBuilder(const FrameResult& result, const std::map<std::string, ObjectBox>& boxes);
  const Detection3DArrayMessage& message() const { return message_; }

 private:
  std::vector<std::string> ids_;
  std::vector<vision_msgs_msg_dds__ObjectHypothesisWithPose_> hypotheses_;
  std::vector<vision_msgs_msg_dds__Detection3D_> detections_;
  Detection3DArrayMessage message_{};
};

/// The pose of highest score (the first of equals), or nothing.
std::optional<PoseStampedMessage> build_object_pose(const FrameResult& result);

/// Everything.
class PoseEstimatesBuilder {
 public:
  explicit PoseEstimatesBuilder(const FrameResult& result);
  const PoseEstimateArrayMessage& message() const { return message_; }

 private:
  std::string text_;
  std::vector<sextant_msgs_msg_dds__PoseEstimate_> estimates_;
  std::vector<sextant_msgs_msg_dds__ObjectOutcome_> objects_;
  PoseEstimateArrayMessage message_{};
};

}  // namespace sextant
