// SPDX-License-Identifier: Apache-2.0
// Poses onto DDS: one call per frame writes the topics of docs/consume-poses.md, spoken as ROS 2 speaks.
#pragma once

#include <Eigen/Core>
#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <string>

#include "runtime/refine/frame_result.h"

namespace sextant {

/// The box around an object, in the mesh's own frame.
struct ObjectBox {
  Eigen::Vector3d centre_m{0, 0, 0};
  Eigen::Vector3d size_m{0, 0, 0};
};

/// What to publish, and where.
struct PublisherOptions {
  unsigned domain = 0;                                  ///< 0..230
  std::string name_space{};                             ///< prefix of all topics, e.g. "arm"; empty: none
  std::string detections_topic = "detections";          ///< empty: off
  std::string object_pose_topic = "object_pose";        ///< empty: off
  std::string pose_estimates_topic = "pose_estimates";  ///< empty: off
  double lease_ms = 500;     ///< deadline of detections, liveliness lease of detections and object_pose
  double max_age_ms = 1000;  ///< lifespan of pose_estimates: a late joiner never gets an older one
  std::map<std::string, ObjectBox> object_boxes{};  ///< by object name, for Detection3D.bbox; missing: size 0
};

/// Called with one line for people when something is wrong that does not stop us.
using WarnFunction = std::function<void(const std::string&)>;

/// What was written.
struct PublisherStatistics {
  std::uint64_t published = 0;  ///< frames
  std::uint64_t timeouts = 0;   ///< messages given up because a reliable reader did not keep up
};

/// A participant and its writers. One thread at a time. Stamps are FrameResult::captured_at, never "now".
class Publisher {
 public:
  /// Throws UsageError for impossible names, DeviceError where DDS cannot start.
  explicit Publisher(PublisherOptions options, WarnFunction warn = {});
  ~Publisher();
  Publisher(const Publisher&) = delete;
  Publisher& operator=(const Publisher&) = delete;

  /// Writes the frame's messages. Throws DeviceError when DDS fails and std::logic_error for a result that
  /// must not leave the process (no stamp, not finite).
  void publish(const FrameResult& result);

  /// Readers on all our topics at this moment.
  int matched_readers() const;
  /// Waits until there is a reader; false after the timeout.
  bool wait_for_reader(std::chrono::milliseconds timeout) const;
  /// Waits until every reliable reader has everything; false after the timeout.
  bool wait_for_acknowledgements(std::chrono::milliseconds timeout) const;

  /// From any thread.
  PublisherStatistics statistics() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sextant
