// SPDX-License-Identifier: Apache-2.0
// The JSON half of message_text.h.
#include <Eigen/Geometry>
#include <nlohmann/json.hpp>
#include <span>

#include "runtime/publish/message_check.h"
#include "runtime/publish/message_text.h"
#include "runtime/refine/frame_result.h"

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
          {"runner_up_margin", e.runner_up_margin},
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

Json json_of(const geometry_msgs_msg_dds__TransformStamped_& t) {
  const auto& at = t.transform.translation;
  const geometry_msgs_msg_dds__Pose_ pose{{at.x, at.y, at.z}, t.transform.rotation};
  return {{"header", json_of(t.header)},
          {"child_frame_id", printable(t.child_frame_id)},
          {"transform",
           {{"translation", {{"x", at.x}, {"y", at.y}, {"z", at.z}}},
            {"rotation", json_of(pose)["orientation"]}}},
          {"camera_from_object", matrix_of(pose)}};
}

Json json_of(const MarkerMessage& m) {
  return {{"header", json_of(m.header)},
          {"ns", printable(m.ns)},
          {"id", m.id},
          {"type", m.type},
          {"action", m.action},
          {"pose", json_of(m.pose)},
          {"scale", {{"x", m.scale.x}, {"y", m.scale.y}, {"z", m.scale.z}}},
          {"color", {{"r", m.color.r}, {"g", m.color.g}, {"b", m.color.b}, {"a", m.color.a}}},
          {"lifetime", {{"sec", m.lifetime.sec}, {"nanosec", m.lifetime.nanosec}}},
          {"points", m.points._length},
          {"text", printable(m.text)}};
}

Json json_of(const diagnostic_msgs_msg_dds__DiagnosticStatus_& s) {
  Json values = Json::object();
  for (std::uint32_t i = 0; i < s.values._length; ++i) {
    values[printable(s.values._buffer[i].key)] = printable(s.values._buffer[i].value);
  }
  return {{"level", s.level},
          {"name", printable(s.name)},
          {"message", printable(s.message)},
          {"hardware_id", printable(s.hardware_id)},
          {"values", values}};
}

Json json_of(const sextant_msgs_msg_dds__ObjectState_& o) {
  return {{"object_id", o.object_id},
          {"object_name", printable(o.object_name)},
          {"model_file", printable(o.model_file)},
          {"enabled", o.enabled},
          {"threshold", o.threshold}};
}

template <typename Sequence>
Json array_of(const Sequence& sequence) {
  Json array = Json::array();
  for (std::uint32_t i = 0; i < sequence._length; ++i) array.push_back(json_of(sequence._buffer[i]));
  return array;
}

Json json_of(const PoseEstimateArrayMessage& message) {
  return {{"header", json_of(message.header)},    {"input_stamp", json_of(message.input_stamp)},
          {"frame_number", message.frame_number}, {"estimates", array_of(message.estimates)},
          {"objects", array_of(message.objects)}, {"nodes", message.nodes},
          {"solve_time_s", message.solve_time_s}, {"age_s", message.age_s},
          {"message", printable(message.message)}};
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

std::string to_json(const PoseEstimateArrayMessage& message) { return json_of(message).dump(); }

std::string to_json(const TfMessage& message) {
  return Json{{"transforms", array_of(message.transforms)}}.dump();
}

std::string to_json(const MarkerArrayMessage& message) {
  return Json{{"markers", array_of(message.markers)}}.dump();
}

std::string to_json(const ImageMessage& message) {
  return Json{{"header", json_of(message.header)},
              {"height", message.height},
              {"width", message.width},
              {"encoding", printable(message.encoding)},
              {"step", message.step}}
      .dump();
}

std::string to_json(const TableEstimateMessage& message) {
  const auto& up = message.up_in_camera;
  return Json{{"header", json_of(message.header)},
              {"up_in_camera", {{"x", up.x}, {"y", up.y}, {"z", up.z}}},
              {"camera_height_m", message.camera_height_m},
              {"pitch_rad", message.pitch_rad},
              {"roll_rad", message.roll_rad},
              {"pose", json_of(message.pose)},
              {"source", message.source}}
      .dump();
}

std::string to_json(const DiagnosticArrayMessage& message) {
  return Json{{"header", json_of(message.header)}, {"status", array_of(message.status)}}.dump();
}

std::string to_json(const CommandMessage& message) {
  return Json{{"request_id", printable(message.request_id)},
              {"kind", message.kind},
              {"object_name", printable(message.object_name)},
              {"model_file", printable(message.model_file)},
              {"value", message.value},
              {"region", std::span(message.region)}}
      .dump();
}

std::string to_json(const CommandAnswerMessage& message) {
  static constexpr const char* kResults[] = {"done", "refused", "failed"};
  Json json{{"request_id", printable(message.request_id)},
            {"kind", message.kind},
            {"result", message.result < 3 ? kResults[message.result] : "?"},
            {"message", printable(message.message)},
            {"objects", array_of(message.objects)},
            {"region", std::span(message.region)},
            {"deadline_ms", message.deadline_ms}};
  json["look"] = message.look.header.stamp.sec != 0 ? json_of(message.look) : Json();
  return json.dump();
}

}  // namespace sextant
