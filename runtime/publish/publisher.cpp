// SPDX-License-Identifier: Apache-2.0
#include "runtime/publish/publisher.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <thread>
#include <utility>
#include <vector>

#include "idl/dds/type_hashes.h"
#include "runtime/publish/dds_entity.h"
#include "runtime/publish/dds_qos.h"
#include "runtime/publish/message_builder.h"
#include "runtime/publish/topics.h"

namespace sextant {

namespace {

constexpr auto kPollInterval = std::chrono::milliseconds(5);

}  // namespace

struct Publisher::Impl {
  /// One topic and its writer; empty where the topic is off.
  struct Writer {
    std::string topic;
    DdsEntity writer;
  };

  PublisherOptions options;
  WarnFunction warn;
  DdsEntity participant;
  Writer detections, object_pose, pose_estimates;
  std::atomic<std::uint64_t> published = 0, timeouts = 0;

  Writer make_writer(const std::string& name, const dds_topic_descriptor_t& type,
                     const QosProfile& profile) const {
    Writer made;
    if (name.empty()) return made;
    made.topic = dds_topic_name(options.name_space, name);
    const QosPointer qos = make_qos(profile);
    // The participant owns the topic.
    const dds_entity_t topic =
        check_dds(dds_create_topic(participant.get(), &type, made.topic.c_str(), nullptr, nullptr),
                  "cannot create topic " + made.topic, "another topic of that name may have another type");
    made.writer = DdsEntity(dds_create_writer(participant.get(), topic, qos.get(), nullptr),
                            "cannot create the writer of " + made.topic);
    return made;
  }

  std::vector<const Writer*> writers() const {
    std::vector<const Writer*> on;
    for (const Writer* writer : {&detections, &object_pose, &pose_estimates}) {
      if (writer->writer) on.push_back(writer);
    }
    return on;
  }

  void write(const Writer& writer, const void* message) {
    const dds_return_t code = dds_write(writer.writer.get(), message);
    if (code == DDS_RETCODE_TIMEOUT) {
      ++timeouts;
      if (warn) warn(fmt::format("{}: a reliable reader does not keep up, a message is lost", writer.topic));
      return;
    }
    check_dds(code, "cannot write " + writer.topic);
  }

  void report_incompatible_readers() const {
    if (!warn) return;
    for (const Writer* writer : writers()) {
      dds_offered_incompatible_qos_status_t status{};
      check_dds(dds_get_offered_incompatible_qos_status(writer->writer.get(), &status),
                "cannot read a status");
      if (status.total_count_change == 0) continue;
      warn(fmt::format("{}: a reader asks for what is not offered and gets nothing: {}", writer->topic,
                       policy_in_words(static_cast<dds_qos_policy_id_t>(status.last_policy_id))));
    }
  }
};

Publisher::Publisher(PublisherOptions options, WarnFunction warn) : impl_(std::make_unique<Impl>()) {
  impl_->options = std::move(options);
  impl_->warn = std::move(warn);
  const PublisherOptions& o = impl_->options;
  impl_->participant = create_participant(o.domain);

  QosProfile detections;
  detections.deadline_ms = o.lease_ms;
  detections.lease_ms = o.lease_ms;
  detections.type_hash = kTypeHashDetection3DArray;
  impl_->detections =
      impl_->make_writer(o.detections_topic, vision_msgs_msg_dds__Detection3DArray__desc, detections);

  QosProfile object_pose;
  object_pose.lease_ms = o.lease_ms;
  object_pose.type_hash = kTypeHashPoseStamped;
  impl_->object_pose =
      impl_->make_writer(o.object_pose_topic, geometry_msgs_msg_dds__PoseStamped__desc, object_pose);

  QosProfile pose_estimates;
  pose_estimates.transient_local = true;
  pose_estimates.depth = 1;
  pose_estimates.lifespan_ms = o.max_age_ms;
  pose_estimates.type_hash = kTypeHashPoseEstimateArray;
  impl_->pose_estimates = impl_->make_writer(o.pose_estimates_topic,
                                             sextant_msgs_msg_dds__PoseEstimateArray__desc, pose_estimates);
}

Publisher::~Publisher() = default;

void Publisher::publish(const FrameResult& result) {
  check_publishable(result);
  if (impl_->detections.writer) {
    const DetectionsBuilder builder(result, impl_->options.object_boxes);
    impl_->write(impl_->detections, &builder.message());
  }
  if (impl_->object_pose.writer) {
    if (const auto message = build_object_pose(result)) impl_->write(impl_->object_pose, &*message);
  }
  if (impl_->pose_estimates.writer) {
    const PoseEstimatesBuilder builder(result);
    impl_->write(impl_->pose_estimates, &builder.message());
  }
  ++impl_->published;
  impl_->report_incompatible_readers();
}

int Publisher::matched_readers() const {
  int readers = 0;
  for (const Impl::Writer* writer : impl_->writers()) {
    dds_publication_matched_status_t status{};
    check_dds(dds_get_publication_matched_status(writer->writer.get(), &status), "cannot read a status");
    readers += static_cast<int>(status.current_count);
  }
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
  for (const Impl::Writer* writer : impl_->writers()) {
    const dds_duration_t left = std::max<dds_duration_t>(0, end - dds_time());
    const dds_return_t code = dds_wait_for_acks(writer->writer.get(), left);
    if (code == DDS_RETCODE_TIMEOUT) return false;
    check_dds(code, "cannot wait for readers of " + writer->topic);
  }
  return true;
}

PublisherStatistics Publisher::statistics() const { return {impl_->published, impl_->timeouts}; }

}  // namespace sextant
