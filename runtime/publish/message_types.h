// SPDX-License-Identifier: Apache-2.0
// The C structs that idlc makes, under names for people, and what DDS needs to know of each.
#pragma once

#include "idl/dds/diagnostic_msgs.h"
#include "idl/dds/geometry_msgs.h"
#include "idl/dds/sensor_msgs.h"
#include "idl/dds/sextant_msgs.h"
#include "idl/dds/tf2_msgs.h"
#include "idl/dds/type_hashes.h"
#include "idl/dds/vision_msgs.h"
#include "idl/dds/visualization_msgs.h"

namespace sextant {

using Detection3DArrayMessage = vision_msgs_msg_dds__Detection3DArray_;
using PoseStampedMessage = geometry_msgs_msg_dds__PoseStamped_;
using TfMessage = tf2_msgs_msg_dds__TFMessage_;
using MarkerMessage = visualization_msgs_msg_dds__Marker_;
using MarkerArrayMessage = visualization_msgs_msg_dds__MarkerArray_;
using ImageMessage = sensor_msgs_msg_dds__Image_;
using DiagnosticArrayMessage = diagnostic_msgs_msg_dds__DiagnosticArray_;
using PoseEstimateArrayMessage = sextant_msgs_msg_dds__PoseEstimateArray_;
using TableEstimateMessage = sextant_msgs_msg_dds__TableEstimate_;
using CommandMessage = sextant_msgs_msg_dds__Command_;
using CommandAnswerMessage = sextant_msgs_msg_dds__CommandAnswer_;

/// A type as endpoints announce it.
struct TopicType {
  const dds_topic_descriptor_t* descriptor;
  const char* hash;  ///< REP-2011, from the .msg files
};

template <typename Message>
TopicType topic_type() = delete;
template <>
inline TopicType topic_type<Detection3DArrayMessage>() {
  return {&vision_msgs_msg_dds__Detection3DArray__desc, kTypeHashDetection3DArray};
}
template <>
inline TopicType topic_type<PoseStampedMessage>() {
  return {&geometry_msgs_msg_dds__PoseStamped__desc, kTypeHashPoseStamped};
}
template <>
inline TopicType topic_type<TfMessage>() {
  return {&tf2_msgs_msg_dds__TFMessage__desc, kTypeHashTFMessage};
}
template <>
inline TopicType topic_type<MarkerArrayMessage>() {
  return {&visualization_msgs_msg_dds__MarkerArray__desc, kTypeHashMarkerArray};
}
template <>
inline TopicType topic_type<ImageMessage>() {
  return {&sensor_msgs_msg_dds__Image__desc, kTypeHashImage};
}
template <>
inline TopicType topic_type<DiagnosticArrayMessage>() {
  return {&diagnostic_msgs_msg_dds__DiagnosticArray__desc, kTypeHashDiagnosticArray};
}
template <>
inline TopicType topic_type<PoseEstimateArrayMessage>() {
  return {&sextant_msgs_msg_dds__PoseEstimateArray__desc, kTypeHashPoseEstimateArray};
}
template <>
inline TopicType topic_type<TableEstimateMessage>() {
  return {&sextant_msgs_msg_dds__TableEstimate__desc, kTypeHashTableEstimate};
}
template <>
inline TopicType topic_type<CommandMessage>() {
  return {&sextant_msgs_msg_dds__Command__desc, kTypeHashCommand};
}
template <>
inline TopicType topic_type<CommandAnswerMessage>() {
  return {&sextant_msgs_msg_dds__CommandAnswer__desc, kTypeHashCommandAnswer};
}

}  // namespace sextant
