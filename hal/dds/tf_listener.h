// SPDX-License-Identifier: Apache-2.0
// tf and tf_static (or one PoseStamped topic) from DDS into a TfBuffer.
#pragma once

#include <chrono>
#include <memory>
#include <mutex>
#include <string>

#include "hal/dds/subscription.h"
#include "hal/dds/tf_buffer.h"

namespace sextant {

struct TfListenerOptions {
  std::string name_space;  ///< before "tf" and "tf_static"; usually empty
  /// A geometry_msgs/PoseStamped: the pose of `pose_child` in the frame that the message names. Empty: none.
  std::string pose_topic;
  std::string pose_child;
};

/// Reads without waiting when it is asked: no thread of its own.
class TfListener {
 public:
  TfListener(std::shared_ptr<const DdsParticipant> participant, const TfListenerOptions& options);

  /// Takes what has arrived.
  void update();
  const TfBuffer& buffer() const { return buffer_; }
  /// Transforms that were refused as nonsense so far.
  std::uint64_t refused() const { return refused_; }

 private:
  void take_transforms(Subscription& subscription, bool is_static);

  TfListenerOptions options_;
  Subscription tf_, tf_static_;
  std::unique_ptr<Subscription> pose_;
  TfBuffer buffer_;
  std::uint64_t refused_ = 0;
};

}  // namespace sextant
