// SPDX-License-Identifier: Apache-2.0
#include "runtime/publish/publisher.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "runtime/publish/dds_entity.h"
#include "runtime/publish/diagnostics_builder.h"
#include "runtime/publish/marker_builder.h"
#include "runtime/publish/message_builder.h"
#include "runtime/publish/message_parts.h"
#include "runtime/publish/topic_writer.h"
#include "runtime/publish/topics.h"

namespace sextant {

namespace {

constexpr auto kPollInterval = std::chrono::milliseconds(5);
/// Pictures may be lost; poses must not wait for them.
constexpr double kPictureBlockingMs = 2;

/// A frame's age, which goes on while its messages are written.
class Age {
 public:
  explicit Age(double seconds) : at_first_ms_(1e3 * seconds) {}
  double ms() const {
    return at_first_ms_ + std::chrono::duration<double, std::milli>(Clock::now() - first_).count();
  }

 private:
  using Clock = std::chrono::steady_clock;
  double at_first_ms_;
  Clock::time_point first_ = Clock::now();
};

}  // namespace

struct Publisher::Impl {
  PublisherOptions options;
  WarnFunction warn;
  std::mutex warn_mutex, shapes_mutex;
  DdsEntity participant;
  TopicWriter detections, object_pose, pose_estimates, tf, markers, annotated, table, diagnostics;
  std::atomic<std::uint64_t> published = 0, timeouts = 0, too_old = 0;

  template <typename Message>
  TopicWriter make_writer(const std::string& name, const QosProfile& profile) const {
    if (name.empty()) return {};
    return {participant.get(), dds_topic_name(options.name_space, name), topic_type<Message>(), profile};
  }

  std::vector<const TopicWriter*> writers() const {
    std::vector<const TopicWriter*> all;
    for (const TopicWriter* writer :
         {&detections, &object_pose, &pose_estimates, &tf, &markers, &annotated, &table, &diagnostics}) {
      if (writer->on()) all.push_back(writer);
    }
    return all;
  }

  void tell(const std::string& line) {
    const std::lock_guard lock(warn_mutex);
    if (warn) warn(line);
  }

  void write(const TopicWriter& writer, const void* message) {
    if (writer.write(message)) return;
    ++timeouts;
    tell(writer.topic() + ": a reliable reader does not keep up, a message is lost");
  }

  void write_fresh(const TopicWriter& writer, const void* message, const Age& age) {
    if (age.ms() <= options.max_age_ms) return write(writer, message);
    ++too_old;
    tell(fmt::format("{}: a message is not written, it is older than {:.0f} ms", writer.topic(),
                     options.max_age_ms));
  }

  void report_refused_readers() {
    for (const TopicWriter* writer : writers()) {
      if (const std::string line = writer->refused_reader(); !line.empty()) tell(line);
    }
  }
};

Publisher::Publisher(PublisherOptions options, WarnFunction warn) : impl_(std::make_unique<Impl>()) {
  impl_->options = std::move(options);
  impl_->warn = std::move(warn);
  const PublisherOptions& o = impl_->options;
  impl_->participant = create_participant(o.domain);

  QosProfile every_frame;
  every_frame.deadline_ms = o.lease_ms;
  every_frame.lease_ms = o.lease_ms;
  impl_->detections = impl_->make_writer<Detection3DArrayMessage>(o.detections_topic, every_frame);

  QosProfile alive;
  alive.lease_ms = o.lease_ms;
  impl_->object_pose = impl_->make_writer<PoseStampedMessage>(o.object_pose_topic, alive);
  impl_->table = impl_->make_writer<TableEstimateMessage>(o.table_topic, alive);

  QosProfile latched;
  latched.transient_local = true;
  latched.depth = 1;
  latched.lease_ms = o.lease_ms;
  latched.lifespan_ms = o.max_age_ms;
  impl_->pose_estimates = impl_->make_writer<PoseEstimateArrayMessage>(o.pose_estimates_topic, latched);

  QosProfile transforms;
  transforms.depth = 100;
  impl_->tf = impl_->make_writer<TfMessage>(o.tf_topic, transforms);

  impl_->diagnostics = impl_->make_writer<DiagnosticArrayMessage>(o.diagnostics_topic, {});

  QosProfile pictures;
  pictures.blocking_ms = kPictureBlockingMs;
  impl_->markers = impl_->make_writer<MarkerArrayMessage>(o.markers_topic, pictures);
  pictures.depth = 2;
  impl_->annotated = impl_->make_writer<ImageMessage>(o.annotated_topic, pictures);
}

Publisher::~Publisher() = default;

void Publisher::publish(const FrameResult& result, double age_s) {
  check_publishable(result);
  const Age age(age_s);
  // Poses first, pictures last.
  if (impl_->pose_estimates.on()) {
    const PoseEstimatesBuilder builder(result, age_s);
    impl_->write_fresh(impl_->pose_estimates, &builder.message(), age);
  }
  if (impl_->object_pose.on()) {
    if (const auto message = build_object_pose(result))
      impl_->write_fresh(impl_->object_pose, &*message, age);
  }
  if (impl_->tf.on() && !result.estimates.empty()) {
    const TfBuilder builder(result, impl_->options.tf_prefix);
    impl_->write_fresh(impl_->tf, &builder.message(), age);
  }
  if (impl_->table.on()) {
    if (const auto message = build_table_estimate(result)) impl_->write_fresh(impl_->table, &*message, age);
  }
  {
    const std::lock_guard lock(impl_->shapes_mutex);
    if (impl_->detections.on()) {
      const DetectionsBuilder builder(result, impl_->options.object_shapes);
      impl_->write_fresh(impl_->detections, &builder.message(), age);
    }
    if (impl_->markers.matched_readers() > 0) {
      MarkerStyle style;
      style.mesh = impl_->options.marker_mesh;
      style.lifetime_s = std::max(0.1, impl_->options.max_age_ms / 1000);
      const MarkersBuilder builder(result, impl_->options.object_shapes, style);
      impl_->write_fresh(impl_->markers, &builder.message(), age);
    }
  }
  ++impl_->published;
  impl_->report_refused_readers();
}

bool Publisher::annotated_wanted() const { return impl_->annotated.matched_readers() > 0; }

void Publisher::publish_annotated(const FrameResult& result, const cv::Mat& rgb, double age_s) {
  if (!impl_->annotated.on()) return;
  const Age age(age_s);
  const cv::Mat packed = rgb.isContinuous() ? rgb : rgb.clone();
  std::string encoding = "rgb8";
  ImageMessage message{};
  message.header = to_header(result);
  message.height = static_cast<std::uint32_t>(packed.rows);
  message.width = static_cast<std::uint32_t>(packed.cols);
  message.encoding = borrowed(encoding);
  message.step = 3 * message.width;
  const std::uint32_t bytes = message.step * message.height;
  message.data = {bytes, bytes, const_cast<std::uint8_t*>(packed.ptr<std::uint8_t>()), false};
  impl_->write_fresh(impl_->annotated, &message, age);
}

void Publisher::publish_diagnostics(const DiagnosticReport& report) {
  const DiagnosticsBuilder builder(report);
  impl_->write(impl_->diagnostics, &builder.message());
}

void Publisher::set_object_shapes(ObjectShapes shapes) {
  const std::lock_guard lock(impl_->shapes_mutex);
  impl_->options.object_shapes = std::move(shapes);
}

void Publisher::leave() { dds_delete(impl_->participant.get()); }

std::int32_t Publisher::participant() const { return impl_->participant.get(); }

int Publisher::matched_readers() const {
  int readers = 0;
  for (const TopicWriter* writer : impl_->writers()) readers += writer->matched_readers();
  return readers;
}

bool Publisher::wait_for_reader(std::chrono::milliseconds timeout) const {
  const auto end = std::chrono::steady_clock::now() + timeout;
  while (matched_readers() == 0) {
    if (std::chrono::steady_clock::now() >= end) return false;
    std::this_thread::sleep_for(kPollInterval);
  }
  return true;
}

bool Publisher::wait_for_acknowledgements(std::chrono::milliseconds timeout) const {
  const dds_time_t end = dds_time() + DDS_MSECS(timeout.count());
  for (const TopicWriter* writer : impl_->writers()) {
    const dds_duration_t left = std::max<dds_duration_t>(0, end - dds_time());
    const dds_return_t code = dds_wait_for_acks(writer->handle(), left);
    if (code == DDS_RETCODE_TIMEOUT) return false;
    check_dds(code, "cannot wait for readers of " + writer->topic());
  }
  return true;
}

PublisherStatistics Publisher::statistics() const {
  return {impl_->published, impl_->timeouts, impl_->too_old};
}

}  // namespace sextant
