// SPDX-License-Identifier: Apache-2.0
// Names on the wire: domains and topics, spelled as ROS 2 spells them.
#pragma once

#include <string>
#include <vector>

namespace sextant {

/// What a topic carries.
enum class TopicKind {
  kDetections,     ///< vision_msgs/Detection3DArray, one per frame, also an empty one
  kObjectPose,     ///< geometry_msgs/PoseStamped, the best pose; silent when there is none
  kPoseEstimates,  ///< sextant_msgs/PoseEstimateArray, everything including the certificates
  kTf,             ///< tf2_msgs/TFMessage, every pose as a transform
  kMarkers,        ///< visualization_msgs/MarkerArray
  kAnnotated,      ///< sensor_msgs/Image
  kTableEstimate,  ///< sextant_msgs/TableEstimate
  kDiagnostics,    ///< diagnostic_msgs/DiagnosticArray
  kCommand,        ///< sextant_msgs/Command
  kCommandAnswer,  ///< sextant_msgs/CommandAnswer
};

/// Throws UsageError unless 0..230 (higher ones have no UDP ports).
void check_domain(unsigned domain);

/// True for a relative ROS 2 name: letters, digits, underscores, tokens separated by "/" and not starting
/// with a digit, at most 200 characters.
bool is_topic_name(const std::string& name);

/// A name as is_topic_name, or one with a leading "/", which no namespace goes before.
bool is_topic_path(const std::string& name);

/// The DDS topic "rt/<name_space>/<name>", or "rt/<name>" of "/<name>". Throws UsageError for names that ROS
/// 2 would refuse.
std::string dds_topic_name(const std::string& name_space, const std::string& name);

/// Usual names of all kinds, for help texts.
std::vector<std::string> topic_kind_names();

/// The kind whose usual name the last token of `name` is; throws UsageError where it is none.
TopicKind topic_kind_of(const std::string& name);

}  // namespace sextant
