// SPDX-License-Identifier: Apache-2.0
// Poses onto DDS: one call per frame writes the topics of docs/consume-poses.md, spoken as ROS 2 speaks.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <opencv2/core.hpp>
#include <string>

#include "runtime/publish/diagnostics.h"
#include "runtime/publish/object_shape.h"
#include "runtime/refine/frame_result.h"

namespace sextant {

/// What to publish, and where. Topics are relative to the name space, or absolute with a leading "/"; an
/// empty one is off.
struct PublisherOptions {
  unsigned domain = 0;       ///< 0..230
  std::string name_space{};  ///< prefix of all topics, e.g. "arm"; empty: none
  std::string detections_topic = "detections";
  std::string object_pose_topic = "object_pose";
  std::string pose_estimates_topic = "pose_estimates";
  std::string tf_topic = "tf";
  std::string markers_topic = "markers";
  std::string annotated_topic = "annotated/image_raw";
  std::string table_topic = "table_estimate";
  std::string diagnostics_topic = "diagnostics";
  std::string tf_prefix{};  ///< before the object's name in child_frame_id
  bool marker_mesh = true;  ///< markers show meshes; else boxes
  double lease_ms =
      500;  ///< deadline of detections, liveliness lease of the topics that say where objects are
  double max_age_ms = 1000;      ///< of every message of a frame; lifespan of pose_estimates
  ObjectShapes object_shapes{};  ///< for Detection3D.bbox and markers; missing: size 0, no shape
};

/// Called with one line for people when something is wrong that does not stop us; one thread at a time.
using WarnFunction = std::function<void(const std::string&)>;

/// What was written.
struct PublisherStatistics {
  std::uint64_t published = 0;  ///< frames
  std::uint64_t timeouts = 0;   ///< messages given up because a reliable reader did not keep up
  std::uint64_t too_old =
      0;  ///< messages of a frame that grew older than max_age_ms while others were written
};

/// A participant and its writers. publish and publish_annotated from one thread, the others from any. Stamps
/// of poses are FrameResult::captured_at, never "now".
class Publisher {
 public:
  /// Throws UsageError for impossible names, DeviceError where DDS cannot start.
  explicit Publisher(PublisherOptions options, WarnFunction warn = {});
  ~Publisher();
  Publisher(const Publisher&) = delete;
  Publisher& operator=(const Publisher&) = delete;

  /// Writes the frame's messages, none of them once it is older than max_age_ms. age_s: from capture to now,
  /// on a clock that nobody sets. Throws DeviceError when DDS fails and std::logic_error for a result that
  /// must not leave the process (no stamp, not finite).
  void publish(const FrameResult& result, double age_s = 0);
  /// True while someone listens to the annotated image: only then is it worth drawing.
  bool annotated_wanted() const;
  /// Writes an image with the frame's stamp and age, as publish does. `rgb`: CV_8UC3, RGB order.
  void publish_annotated(const FrameResult& result, const cv::Mat& rgb, double age_s = 0);
  void publish_diagnostics(const DiagnosticReport& report);

  /// Other objects from the next frame on.
  void set_object_shapes(ObjectShapes shapes);

  /// Takes everything of ours off the network at once; from any thread. What is written afterwards throws
  /// DeviceError.
  void leave();

  /// Cyclone's handle of the participant, for further endpoints of this process; lives as long as this.
  std::int32_t participant() const;
  /// Readers on all our topics at this moment.
  int matched_readers() const;
  /// Waits until there is a reader; false after the timeout.
  bool wait_for_reader(std::chrono::milliseconds timeout) const;
  /// Waits until every reliable reader has everything; false after the timeout.
  bool wait_for_acknowledgements(std::chrono::milliseconds timeout) const;
  PublisherStatistics statistics() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sextant
