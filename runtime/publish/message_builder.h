// SPDX-License-Identifier: Apache-2.0
// FrameResult -> the messages of idl/. Strings point into the FrameResult and arrays into the builder, so
// that a write serialises once and copies nothing before: both must outlive the write.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "runtime/publish/message_types.h"
#include "runtime/publish/object_shape.h"
#include "runtime/refine/frame_result.h"

namespace sextant {

/// Throws std::logic_error for a result that must not leave the process: no capture stamp (or one that ROS
/// cannot say, before 1970 or after 2038), a pose that is not finite or not a rotation, a score outside 0..1.
void check_publishable(const FrameResult& result);

/// One message per estimate with its 3D box, in the order of the result.
class DetectionsBuilder {
 public:
  DetectionsBuilder(const FrameResult& result, const ObjectShapes& shapes);
  const Detection3DArrayMessage& message() const { return message_; }

 private:
  std::vector<std::string> ids_;
  std::vector<vision_msgs_msg_dds__ObjectHypothesisWithPose_> hypotheses_;
  std::vector<vision_msgs_msg_dds__Detection3D_> detections_;
  Detection3DArrayMessage message_{};
};

/// The pose of highest score (the first of equals), or nothing.
std::optional<PoseStampedMessage> build_object_pose(const FrameResult& result);

/// Every pose as a transform from the camera's frame to a frame named prefix + object name; the second and
/// further poses of one object get "_2", "_3", ... at the end.
class TfBuilder {
 public:
  TfBuilder(const FrameResult& result, const std::string& prefix);
  const TfMessage& message() const { return message_; }

 private:
  std::vector<std::string> names_;
  std::vector<geometry_msgs_msg_dds__TransformStamped_> transforms_;
  TfMessage message_{};
};

/// Where the table is, or nothing where no table was used.
std::optional<TableEstimateMessage> build_table_estimate(const FrameResult& result);

/// Everything. age_s: from capture to publication.
class PoseEstimatesBuilder {
 public:
  PoseEstimatesBuilder(const FrameResult& result, double age_s);
  const PoseEstimateArrayMessage& message() const { return message_; }

 private:
  std::string text_;
  std::vector<sextant_msgs_msg_dds__PoseEstimate_> estimates_;
  std::vector<sextant_msgs_msg_dds__ObjectOutcome_> objects_;
  PoseEstimateArrayMessage message_{};
};

}  // namespace sextant
