// SPDX-License-Identifier: Apache-2.0
// The JSON half of message_text.h.
#include <Eigen/Geometry>
#include <nlohmann/json.hpp>
#include <span>

#include "runtime/publish/message_check.h"
#include "runtime/publish/message_text.h"

namespace sextant {

namespace {

using Json = nlohmann::ordered_json;

Json json_of(const builtin_interfaces_msg_dds__Time_& time) {
  return {{"sec", time.sec}, {"nanosec", time.nanosec}};
}

Json json_of(const std_msgs_msg_dds__Header_& header) {
  return {{"stamp", json_of(header.stamp)}, {"frame_id", printable(header.frame_id)}};
}

Json json_of(const geometry_msgs_msg_dds__Pose_& pose) {
  const auto& p = pose.position;
  const auto& q = pose.orientation;
  return {{"position", {{"x", p.x}, {"y", p.y}, {"z", p.z}}},
          {"orientation", {{"x", q.x}, {"y", q.y}, {"z", q.z}, {"w", q.w}}}};
}

Json json_of(const geometry_msgs_msg_dds__PoseWithCovariance_& pose) {
  return {{"pose", json_of(pose.pose)}, {"covariance", std::span(pose.covariance)}};
}

/// 4x4 row-major, metres.
Json matrix_of(const geometry_msgs_msg_dds__Pose_& pose) {
  const auto& q = pose.orientation;
  Eigen::Isometry3d transform(Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized());
  transform.translation() = Eigen::Vector3d(pose.position.x, pose.position.y, pose.position.z);
  const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> matrix = transform.matrix();
  return std::span(matrix.data(), 16);
}

Json json_of(const vision_msgs_msg_dds__Detection3D_& detection) {
  Json results = Json::array();
  for (std::uint32_t i = 0; i < detection.results._length; ++i) {
    const auto& result = detection.results._buffer[i];
    results.push_back(
        {{"hypothesis",
          {{"class_id", printable(result.hypothesis.class_id)}, {"score", result.hypothesis.score}}},
         {"pose", json_of(result.pose)},
         {"camera_from_object", matrix_of(result.pose.pose)}});
  }
  const auto& size = detection.bbox.size;
  return {
      {"results", results},
      {"bbox",
       {{"center", json_of(detection.bbox.center)}, {"size", {{"x", size.x}, {"y", size.y}, {"z", size.z}}}}},
      {"id", printable(detection.id)}};
}

Json json_of(const sextant_msgs_msg_dds__PoseEstimate_& e) {
  return {{"object_id", e.object_id},
          {"object_name", printable(e.object_name)},
          {"pose", json_of(e.pose)},
          {"camera_from_object", matrix_of(e.pose.pose)},
          {"score", e.score},
          {"log_score", e.log_score},
          {"upper_bound", e.upper_bound},
          {"gap", e.gap},
          {"status", to_string(static_cast<SearchStatus>(e.status))},
          {"bbox", std::span(e.bbox)}};
}

Json json_of(const sextant_msgs_msg_dds__ObjectOutcome_& object) {
  return {{"object_id", object.object_id},
          {"object_name", printable(object.object_name)},
          {"status", to_string(static_cast<SearchStatus>(object.status))},
          {"upper_bound", object.upper_bound},
          {"threshold", object.threshold},
          {"coverage", object.coverage}};
}

template <typename Sequence>
Json array_of(const Sequence& sequence) {
  Json array = Json::array();
  for (std::uint32_t i = 0; i < sequence._length; ++i) array.push_back(json_of(sequence._buffer[i]));
  return array;
}

}  // namespace

std::string to_json(const Detection3DArrayMessage& message) {
  return Json{{"header", json_of(message.header)}, {"detections", array_of(message.detections)}}.dump();
}

std::string to_json(const PoseStampedMessage& message) {
  return Json{{"header", json_of(message.header)},
              {"pose", json_of(message.pose)},
              {"camera_from_object", matrix_of(message.pose)}}
      .dump();
}

std::string to_json(const PoseEstimateArrayMessage& message) {
  return Json{{"header", json_of(message.header)},    {"input_stamp", json_of(message.input_stamp)},
              {"frame_number", message.frame_number}, {"estimates", array_of(message.estimates)},
              {"objects", array_of(message.objects)}, {"nodes", message.nodes},
              {"solve_time_s", message.solve_time_s}, {"message", printable(message.message)}}
      .dump();
}

}  // namespace sextant
