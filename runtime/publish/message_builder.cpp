// SPDX-License-Identifier: Apache-2.0
#include "runtime/publish/message_builder.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace sextant {

namespace {

constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;
/// How far R^T R may be from the identity.
constexpr double kRotationTolerance = 1e-6;

/// The C structs want char*, and writing never changes what it points to.
char* borrowed(const std::string& text) { return const_cast<char*>(text.c_str()); }

builtin_interfaces_msg_dds__Time_ to_time(CaptureTime time) {
  const std::int64_t ns = time.time_since_epoch().count();
  return {static_cast<std::int32_t>(ns / kNanosecondsPerSecond),
          static_cast<std::uint32_t>(ns % kNanosecondsPerSecond)};
}

std_msgs_msg_dds__Header_ to_header(const FrameResult& result) {
  return {to_time(result.captured_at), borrowed(result.frame_id)};
}

geometry_msgs_msg_dds__Pose_ to_pose(const RigidTransform& transform) {
  const Eigen::Vector3d t = transform.translation();
  Eigen::Quaterniond q(Eigen::Matrix3d(transform.linear()));
  q.normalize();
  if (q.w() < 0) q.coeffs() *= -1;  // one of the two equal quaternions, always the same
  return {{t.x(), t.y(), t.z()}, {q.x(), q.y(), q.z(), q.w()}};
}

geometry_msgs_msg_dds__PoseWithCovariance_ to_pose_with_covariance(const PoseEstimate& estimate) {
  geometry_msgs_msg_dds__PoseWithCovariance_ message{};
  message.pose = to_pose(estimate.camera_from_object);
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 6; ++column)
      message.covariance[row * 6 + column] = estimate.covariance(row, column);
  }
  return message;
}

/// A DDS sequence over memory that it does not own.
template <typename Sequence, typename Element>
Sequence borrowed_sequence(std::vector<Element>& elements) {
  const auto size = static_cast<std::uint32_t>(elements.size());
  return {size, size, elements.data(), false};
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
    require(!std::isnan(e.log_score) && !std::isnan(e.upper_bound) && !std::isnan(e.gap),
            "a bound is not a number");
    require(std::all_of(e.bbox.begin(), e.bbox.end(), [](double d) { return std::isfinite(d); }),
            "a bounding box is not finite");
  }
  for (const ObjectOutcome& object : result.objects) {
    require(!std::isnan(object.upper_bound) && !std::isnan(object.threshold), "a bound is not a number");
    require(object.coverage >= 0 && object.coverage <= 1, "a coverage is outside 0..1");
  }
}

DetectionsBuilder::DetectionsBuilder(const FrameResult& result,
                                     const std::map<std::string, ObjectBox>& boxes) {
  const std::size_t count = result.estimates.size();
  ids_.reserve(count);
  hypotheses_.reserve(count);
  detections_.reserve(count);
  message_.header = to_header(result);
  for (const PoseEstimate& estimate : result.estimates) {
    ids_.push_back(std::to_string(estimate.object_id));
    hypotheses_.push_back(
        {{borrowed(estimate.object_name), estimate.score}, to_pose_with_covariance(estimate)});
    ObjectBox box;
    if (const auto found = boxes.find(estimate.object_name); found != boxes.end()) box = found->second;
    RigidTransform camera_from_box = estimate.camera_from_object;
    camera_from_box.translate(box.centre_m);
    vision_msgs_msg_dds__Detection3D_ detection{};
    detection.header = message_.header;
    detection.results = {1, 1, &hypotheses_.back(), false};
    detection.bbox = {to_pose(camera_from_box), {box.size_m.x(), box.size_m.y(), box.size_m.z()}};
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

PoseEstimatesBuilder::PoseEstimatesBuilder(const FrameResult& result) : text_(in_words(result)) {
  for (const PoseEstimate& estimate : result.estimates) {
    sextant_msgs_msg_dds__PoseEstimate_ message{};
    message.object_id = estimate.object_id;
    message.object_name = borrowed(estimate.object_name);
    message.pose = to_pose_with_covariance(estimate);
    message.score = estimate.score;
    message.log_score = estimate.log_score;
    message.upper_bound = estimate.upper_bound;
    message.gap = estimate.gap;
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
  message_.message = borrowed(text_);
}

}  // namespace sextant
