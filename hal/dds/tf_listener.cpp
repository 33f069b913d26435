// SPDX-License-Identifier: Apache-2.0
#include "hal/dds/tf_listener.h"

#include <cmath>
#include <optional>
#include <span>

#include "hal/dds/image_message.h"
#include "idl/dds/geometry_msgs.h"
#include "idl/dds/tf2_msgs.h"
#include "idl/dds/type_hashes.h"
#include "runtime/base/error.h"

namespace sextant {
namespace {

constexpr int kDepth = 100;
constexpr std::uint32_t kMostTransforms = 1000;

std::string in_name_space(const std::string& name_space, const char* name) {
  return name_space.empty() ? name : name_space + "/" + name;
}

SubscriptionOptions tf_options(const TfListenerOptions& options, bool is_static) {
  SubscriptionOptions s;
  s.topic = in_name_space(options.name_space, is_static ? "tf_static" : "tf");
  s.type = &tf2_msgs_msg_dds__TFMessage__desc;
  s.type_hash = kTypeHashTFMessage;
  s.depth = kDepth;
  s.latched = is_static;
  return s;
}

SubscriptionOptions pose_options(const std::string& topic) {
  SubscriptionOptions s;
  s.topic = topic;
  s.type = &geometry_msgs_msg_dds__PoseStamped__desc;
  s.type_hash = kTypeHashPoseStamped;
  return s;
}

/// Nothing where the numbers are no rigid motion.
std::optional<RigidTransform> transform_of(const auto& p, const geometry_msgs_msg_dds__Quaternion_& q) {
  const Eigen::Quaterniond rotation(q.w, q.x, q.y, q.z);
  // Written so that a NaN fails.
  if (!(std::abs(rotation.norm() - 1) < 1e-2)) return std::nullopt;
  RigidTransform t = RigidTransform::Identity();
  t.linear() = rotation.normalized().toRotationMatrix();
  t.translation() = Eigen::Vector3d(p.x, p.y, p.z);
  return t;
}

}  // namespace

TfListener::TfListener(std::shared_ptr<const DdsParticipant> participant, const TfListenerOptions& options)
    : options_(options),
      tf_(participant, tf_options(options, false)),
      tf_static_(participant, tf_options(options, true)) {
  if (!options_.pose_topic.empty()) {
    pose_ = std::make_unique<Subscription>(participant, pose_options(options_.pose_topic));
  }
}

void TfListener::take_transforms(Subscription& subscription, bool is_static) {
  subscription.wait_and_take(std::chrono::milliseconds(0), [&](const void* sample) {
    const auto& message = *static_cast<const tf2_msgs_msg_dds__TFMessage_*>(sample);
    const std::uint32_t count = std::min(message.transforms._length, kMostTransforms);
    refused_ += message.transforms._length - count;
    for (const auto& t : std::span(message.transforms._buffer, count)) {
      try {
        const auto transform = transform_of(t.transform.translation, t.transform.rotation);
        const bool good =
            transform &&
            buffer_.add(
                {frame_of(t.header.frame_id, subscription.topic()),
                 frame_of(t.child_frame_id, subscription.topic()),
                 time_of(t.header.stamp.sec, t.header.stamp.nanosec, subscription.topic()), *transform},
                is_static);
        refused_ += good ? 0U : 1U;
      } catch (const std::exception&) {
        ++refused_;
      }
    }
  });
}

void TfListener::update() {
  take_transforms(tf_static_, true);
  take_transforms(tf_, false);
  if (!pose_) return;
  pose_->wait_and_take(std::chrono::milliseconds(0), [&](const void* sample) {
    const auto& message = *static_cast<const geometry_msgs_msg_dds__PoseStamped_*>(sample);
    try {
      const auto transform = transform_of(message.pose.position, message.pose.orientation);
      const bool good =
          transform &&
          buffer_.add(
              {frame_of(message.header.frame_id, pose_->topic()), options_.pose_child,
               time_of(message.header.stamp.sec, message.header.stamp.nanosec, pose_->topic()), *transform},
              false);
      refused_ += good ? 0U : 1U;
    } catch (const std::exception&) {
      ++refused_;
    }
  });
}

}  // namespace sextant
