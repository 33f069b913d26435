// SPDX-License-Identifier: Apache-2.0
// The small parts that all our messages are made of. Nothing is copied that need not be: strings and arrays
// point into what they were made from, which must outlive the write.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <string>
#include <vector>

#include "runtime/geometry/rigid_transform.h"
#include "runtime/publish/message_types.h"
#include "runtime/refine/frame_result.h"

namespace sextant {

inline constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;

/// The C structs want char*, and writing never changes what it points to.
inline char* borrowed(const std::string& text) { return const_cast<char*>(text.c_str()); }

/// A DDS sequence over memory that it does not own.
template <typename Sequence, typename Element>
Sequence borrowed_sequence(std::vector<Element>& elements) {
  const auto size = static_cast<std::uint32_t>(elements.size());
  return {size, size, elements.data(), false};
}

inline builtin_interfaces_msg_dds__Time_ to_time(CaptureTime time) {
  const std::int64_t ns = time.time_since_epoch().count();
  return {static_cast<std::int32_t>(ns / kNanosecondsPerSecond),
          static_cast<std::uint32_t>(ns % kNanosecondsPerSecond)};
}

inline std_msgs_msg_dds__Header_ to_header(const FrameResult& result) {
  return {to_time(result.captured_at), borrowed(result.frame_id)};
}

/// The unit quaternion of a rotation; of the two equal ones always that with w >= 0.
inline Eigen::Quaterniond to_quaternion(const RigidTransform& transform) {
  Eigen::Quaterniond q(Eigen::Matrix3d(transform.linear()));
  q.normalize();
  if (q.w() < 0) q.coeffs() *= -1;
  return q;
}

inline geometry_msgs_msg_dds__Pose_ to_pose(const RigidTransform& transform) {
  const Eigen::Vector3d t = transform.translation();
  const Eigen::Quaterniond q = to_quaternion(transform);
  return {{t.x(), t.y(), t.z()}, {q.x(), q.y(), q.z(), q.w()}};
}

}  // namespace sextant
