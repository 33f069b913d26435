// SPDX-License-Identifier: Apache-2.0
#include "runtime/publish/message_check.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <initializer_list>
#include <span>

#include "runtime/base/error.h"
#include "runtime/refine/frame_result.h"

namespace sextant {

namespace {

constexpr std::size_t kLongestText = 1024;
constexpr std::uint32_t kMostElements = 10'000;
constexpr std::uint32_t kMostPoints = 10'000'000;
constexpr std::uint32_t kLargestSide = 65536;
constexpr std::size_t kLongestRequestId = 64;
constexpr double kFarthestMetres = 1e6;
constexpr double kLargestPixel = 1e6;
constexpr double kQuaternionTolerance = 1e-3;
constexpr std::uint32_t kNanosecondsPerSecond = 1'000'000'000;

/// Collects where we are, and throws for the first thing that is wrong.
struct Checker {
  const std::string& topic;

  void require(bool good, const char* what) const {
    if (!good) throw InputError(topic, what, "message ignored");
  }
  void text(const char* text) const {
    require(text != nullptr && strnlen(text, kLongestText + 1) <= kLongestText, "a text is absurdly long");
  }
  void count(std::uint32_t length) const { require(length <= kMostElements, "an absurd number of elements"); }
  void within(double value, double limit, const char* what) const { require(std::abs(value) <= limit, what); }

  void time(const builtin_interfaces_msg_dds__Time_& stamp) const {
    require(stamp.sec >= 0 && stamp.nanosec < kNanosecondsPerSecond, "a stamp is no time");
  }
  void header(const std_msgs_msg_dds__Header_& header) const {
    time(header.stamp);
    text(header.frame_id);
  }
  void pose(const geometry_msgs_msg_dds__Pose_& pose) const {
    for (const double d : {pose.position.x, pose.position.y, pose.position.z}) {
      within(d, kFarthestMetres, "a position is not finite or absurdly far");
    }
    const auto& q = pose.orientation;
    // Written so that a NaN fails.
    within(std::hypot(std::hypot(q.x, q.y), std::hypot(q.z, q.w)) - 1, kQuaternionTolerance,
           "an orientation is not a unit quaternion");
  }
  void pose(const geometry_msgs_msg_dds__PoseWithCovariance_& message) const {
    pose(message.pose);
    require(std::all_of(std::begin(message.covariance), std::end(message.covariance),
                        [](double d) { return std::isfinite(d); }),
            "a covariance is not finite");
    for (int i = 0; i < 6; ++i) require(message.covariance[7 * i] >= 0, "a variance is negative");
  }
  void bound(double value) const { require(!std::isnan(value), "a bound is not a number"); }
  void unit(double value, const char* what) const { require(value >= 0 && value <= 1, what); }
  void finite(std::initializer_list<double> values, const char* what) const {
    for (const double value : values) require(std::isfinite(value), what);
  }
  void colour(const std_msgs_msg_dds__ColorRGBA_& c) const {
    for (const float f : {c.r, c.g, c.b, c.a}) require(f >= 0 && f <= 1, "a colour is outside 0..1");
  }
  void status(std::uint8_t value) const {
    require(value <= static_cast<std::uint8_t>(SearchStatus::kAbsent), "an unknown status");
  }
};

template <typename Sequence>
auto elements(const Sequence& sequence) {
  return std::span(sequence._buffer, sequence._length);
}

}  // namespace

void check_message(const Detection3DArrayMessage& message, const std::string& topic) {
  const Checker check{topic};
  check.header(message.header);
  check.count(message.detections._length);
  for (const auto& detection : elements(message.detections)) {
    check.header(detection.header);
    check.text(detection.id);
    check.pose(detection.bbox.center);
    for (const double d : {detection.bbox.size.x, detection.bbox.size.y, detection.bbox.size.z}) {
      check.require(d >= 0 && d <= kFarthestMetres, "a box has an impossible size");
    }
    check.count(detection.results._length);
    for (const auto& result : elements(detection.results)) {
      check.text(result.hypothesis.class_id);
      check.unit(result.hypothesis.score, "a score is outside 0..1");
      check.pose(result.pose);
    }
  }
}

void check_message(const PoseStampedMessage& message, const std::string& topic) {
  const Checker check{topic};
  check.header(message.header);
  check.pose(message.pose);
}

void check_message(const PoseEstimateArrayMessage& message, const std::string& topic) {
  const Checker check{topic};
  check.header(message.header);
  check.time(message.input_stamp);
  check.text(message.message);
  check.require(message.solve_time_s >= 0 && std::isfinite(message.solve_time_s), "an impossible solve time");
  check.require(std::isfinite(message.age_s), "an impossible age");
  check.count(message.estimates._length);
  for (const auto& estimate : elements(message.estimates)) {
    check.text(estimate.object_name);
    check.pose(estimate.pose);
    check.unit(estimate.score, "a score is outside 0..1");
    check.bound(estimate.log_score);
    check.bound(estimate.upper_bound);
    check.require(estimate.gap >= 0, "a gap is negative or not a number");
    check.bound(estimate.runner_up_margin);
    check.status(estimate.status);
    for (const double d : estimate.bbox)
      check.within(d, kLargestPixel, "a bounding box is not finite or absurd");
    check.require(estimate.bbox[2] >= 0 && estimate.bbox[3] >= 0, "a bounding box has a negative size");
  }
  check.count(message.objects._length);
  for (const auto& object : elements(message.objects)) {
    check.text(object.object_name);
    check.status(object.status);
    check.bound(object.upper_bound);
    check.bound(object.threshold);
    check.unit(object.coverage, "a coverage is outside 0..1");
  }
}

void check_message(const TfMessage& message, const std::string& topic) {
  const Checker check{topic};
  check.count(message.transforms._length);
  for (const auto& transform : elements(message.transforms)) {
    check.header(transform.header);
    check.text(transform.child_frame_id);
    const auto& t = transform.transform.translation;
    check.pose({{t.x, t.y, t.z}, transform.transform.rotation});
  }
}

void check_message(const MarkerArrayMessage& message, const std::string& topic) {
  const Checker check{topic};
  check.count(message.markers._length);
  for (const auto& marker : elements(message.markers)) {
    check.header(marker.header);
    check.text(marker.ns);
    check.text(marker.text);
    check.pose(marker.pose);
    check.colour(marker.color);
    check.finite({marker.scale.x, marker.scale.y, marker.scale.z}, "a scale is not finite");
    check.require(marker.points._length <= kMostPoints && marker.colors._length <= kMostPoints,
                  "an absurd number of points");
    for (const auto& p : elements(marker.points)) check.finite({p.x, p.y, p.z}, "a point is not finite");
    for (const auto& c : elements(marker.colors)) check.colour(c);
  }
}

void check_message(const ImageMessage& message, const std::string& topic) {
  const Checker check{topic};
  check.header(message.header);
  check.text(message.encoding);
  check.require(message.width <= kLargestSide && message.height <= kLargestSide, "an absurd image size");
  check.require(std::uint64_t{message.step} * message.height == message.data._length,
                "the image's data are not step * height bytes");
}

void check_message(const TableEstimateMessage& message, const std::string& topic) {
  const Checker check{topic};
  check.header(message.header);
  check.pose(message.pose);
  const auto& up = message.up_in_camera;
  check.within(std::hypot(up.x, up.y, up.z) - 1, kQuaternionTolerance,
               "the table's normal is no unit vector");
  check.within(message.camera_height_m, kFarthestMetres, "an absurd height above the table");
  check.finite({message.pitch_rad, message.roll_rad}, "an angle is not finite");
}

void check_message(const DiagnosticArrayMessage& message, const std::string& topic) {
  const Checker check{topic};
  check.header(message.header);
  check.count(message.status._length);
  for (const auto& status : elements(message.status)) {
    check.text(status.name);
    check.text(status.message);
    check.text(status.hardware_id);
    check.count(status.values._length);
    for (const auto& value : elements(status.values)) {
      check.text(value.key);
      check.text(value.value);
    }
  }
}

void check_message(const CommandMessage& message, const std::string& topic) {
  const Checker check{topic};
  check.text(message.request_id);
  const std::size_t length = std::strlen(message.request_id);
  check.require(
      length >= 1 && length <= kLongestRequestId && printable(message.request_id) == message.request_id,
      "a request id is not 1 to 64 printable characters");
  check.text(message.object_name);
  check.text(message.model_file);
}

void check_message(const CommandAnswerMessage& message, const std::string& topic) {
  const Checker check{topic};
  for (const char* text : {message.request_id, message.message}) check.text(text);
  check.count(message.objects._length);
  for (const auto& object : elements(message.objects)) {
    check.text(object.object_name);
    check.text(object.model_file);
  }
  check.require(message.deadline_ms >= 0 && std::isfinite(message.deadline_ms), "an impossible deadline");
  check_message(message.look, topic);
}

std::string printable(const char* text) {
  std::string out(text);
  std::replace_if(
      out.begin(), out.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return out;
}

}  // namespace sextant
