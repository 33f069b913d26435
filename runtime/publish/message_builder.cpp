// SPDX-License-Identifier: Apache-2.0
#include "runtime/publish/message_builder.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>

#include "runtime/publish/message_parts.h"

namespace sextant {

namespace {

/// How far R^T R may be from the identity.
constexpr double kRotationTolerance = 1e-6;

geometry_msgs_msg_dds__PoseWithCovariance_ to_pose_with_covariance(const PoseEstimate& estimate) {
  geometry_msgs_msg_dds__PoseWithCovariance_ message{};
  message.pose = to_pose(estimate.camera_from_object);
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 6; ++column)
      message.covariance[row * 6 + column] = estimate.covariance(row, column);
  }
  return message;
}

std::string in_words(const FrameResult& result) {
  std::string text =
      fmt::format("{} pose{}", result.estimates.size(), result.estimates.size() == 1 ? "" : "s");
  for (const ObjectOutcome& object : result.objects) {
    const auto poses = std::count_if(result.estimates.begin(), result.estimates.end(),
                                     [&](const PoseEstimate& e) { return e.object_id == object.object_id; });
    text += fmt::format("; {}: {}, {}", object.object_name, poses, to_string(object.status));
  }
  return text;
}

void require(bool good, const std::string& what) {
  if (!good) throw std::logic_error("result is not fit to publish: " + what);
}

}  // namespace

void check_publishable(const FrameResult& result) {
  const std::int64_t ns = result.captured_at.time_since_epoch().count();
  require(ns > 0, "it has no capture time");
  require(std::isfinite(result.seconds.total), "its solve time is not finite");
  require(ns / kNanosecondsPerSecond <= std::numeric_limits<std::int32_t>::max(),
          "its capture time is beyond 2038");
  for (const PoseEstimate& e : result.estimates) {
    const Eigen::Matrix3d rotation = e.camera_from_object.linear();
    require(e.camera_from_object.matrix().allFinite(), "a pose is not finite");
    require((rotation.transpose() * rotation).isIdentity(kRotationTolerance) && rotation.determinant() > 0,
            "a pose is not a rigid transform");
    require(e.covariance.allFinite(), "a covariance is not finite");
    require(e.score >= 0 && e.score <= 1, "a score is outside 0..1");
    require(!std::isnan(e.log_score) && !std::isnan(e.upper_bound) && !std::isnan(e.gap) &&
                !std::isnan(e.runner_up_margin),
            "a bound is not a number");
    require(std::all_of(e.bbox.begin(), e.bbox.end(), [](double d) { return std::isfinite(d); }),
            "a bounding box is not finite");
  }
  if (result.table) {
    require(result.table->up_in_camera.allFinite() && result.table->up_in_camera.norm() > 0.5 &&
                std::isfinite(result.table->camera_height_m),
            "its table is no plane");
  }
  for (const ObjectOutcome& object : result.objects) {
    require(!std::isnan(object.upper_bound) && !std::isnan(object.threshold), "a bound is not a number");
    require(object.coverage >= 0 && object.coverage <= 1, "a coverage is outside 0..1");
  }
}

DetectionsBuilder::DetectionsBuilder(const FrameResult& result, const ObjectShapes& shapes) {
  const std::size_t count = result.estimates.size();
  ids_.reserve(count);
  hypotheses_.reserve(count);
  detections_.reserve(count);
  message_.header = to_header(result);
  for (const PoseEstimate& estimate : result.estimates) {
    ids_.push_back(std::to_string(estimate.object_id));
    hypotheses_.push_back(
        {{borrowed(estimate.object_name), estimate.score}, to_pose_with_covariance(estimate)});
    Eigen::Vector3d centre(0, 0, 0), size(0, 0, 0);
    if (const auto found = shapes.find(estimate.object_name); found != shapes.end()) {
      centre = found->second.centre_m;
      size = found->second.size_m;
    }
    RigidTransform camera_from_box = estimate.camera_from_object;
    camera_from_box.translate(centre);
    vision_msgs_msg_dds__Detection3D_ detection{};
    detection.header = message_.header;
    detection.results = {1, 1, &hypotheses_.back(), false};
    detection.bbox = {to_pose(camera_from_box), {size.x(), size.y(), size.z()}};
    detection.id = borrowed(ids_.back());
    detections_.push_back(detection);
  }
  message_.detections = borrowed_sequence<decltype(message_.detections)>(detections_);
}

std::optional<PoseStampedMessage> build_object_pose(const FrameResult& result) {
  const auto best =
      std::max_element(result.estimates.begin(), result.estimates.end(),
                       [](const PoseEstimate& a, const PoseEstimate& b) { return a.score < b.score; });
  if (best == result.estimates.end()) return std::nullopt;
  return PoseStampedMessage{to_header(result), to_pose(best->camera_from_object)};
}

TfBuilder::TfBuilder(const FrameResult& result, const std::string& prefix) {
  names_.reserve(result.estimates.size());
  std::map<std::string, int> seen;
  for (const PoseEstimate& estimate : result.estimates) {
    const int number = ++seen[estimate.object_name];
    names_.push_back(prefix + estimate.object_name + (number > 1 ? fmt::format("_{}", number) : ""));
    const geometry_msgs_msg_dds__Pose_ pose = to_pose(estimate.camera_from_object);
    transforms_.push_back({to_header(result),
                           borrowed(names_.back()),
                           {{pose.position.x, pose.position.y, pose.position.z}, pose.orientation}});
  }
  message_.transforms = borrowed_sequence<decltype(message_.transforms)>(transforms_);
}

std::optional<TableEstimateMessage> build_table_estimate(const FrameResult& result) {
  if (!result.table) return std::nullopt;
  const TableGeometry& table = *result.table;
  const Eigen::Vector3d up = table.up_in_camera.normalized();
  // Straight down there is no direction in which the camera looks: then x is where the image's top points.
  Eigen::Vector3d ahead = Eigen::Vector3d::UnitZ() - up * up.z();
  if (ahead.norm() < 1e-6) ahead = -Eigen::Vector3d::UnitY() + up * up.y();
  ahead.normalize();
  RigidTransform camera_from_table = RigidTransform::Identity();
  camera_from_table.linear() << ahead, up.cross(ahead), up;
  camera_from_table.translation() = -up * table.camera_height_m;
  TableEstimateMessage message{};
  message.header = to_header(result);
  message.up_in_camera = {up.x(), up.y(), up.z()};
  message.camera_height_m = table.camera_height_m;
  message.pitch_rad = table.pitch_rad();
  message.roll_rad = table.roll_rad();
  message.pose = to_pose(camera_from_table);
  message.source = static_cast<std::uint8_t>(result.table_origin);
  return message;
}

PoseEstimatesBuilder::PoseEstimatesBuilder(const FrameResult& result, double age_s)
    : text_(in_words(result)) {
  for (const PoseEstimate& estimate : result.estimates) {
    sextant_msgs_msg_dds__PoseEstimate_ message{};
    message.object_id = estimate.object_id;
    message.object_name = borrowed(estimate.object_name);
    message.pose = to_pose_with_covariance(estimate);
    message.score = estimate.score;
    message.log_score = estimate.log_score;
    message.upper_bound = estimate.upper_bound;
    message.gap = estimate.gap;
    message.runner_up_margin = estimate.runner_up_margin;
    message.status = static_cast<std::uint8_t>(estimate.status);
    std::copy(estimate.bbox.begin(), estimate.bbox.end(), message.bbox);
    estimates_.push_back(message);
  }
  for (const ObjectOutcome& object : result.objects) {
    objects_.push_back({object.object_id, borrowed(object.object_name),
                        static_cast<std::uint8_t>(object.status), object.upper_bound, object.threshold,
                        object.coverage});
  }
  message_.header = to_header(result);
  message_.input_stamp = message_.header.stamp;
  message_.frame_number = result.sequence;
  message_.estimates = borrowed_sequence<decltype(message_.estimates)>(estimates_);
  message_.objects = borrowed_sequence<decltype(message_.objects)>(objects_);
  message_.nodes = result.nodes;
  message_.solve_time_s = result.seconds.total;
  message_.age_s = age_s;
  message_.message = borrowed(text_);
}

}  // namespace sextant
