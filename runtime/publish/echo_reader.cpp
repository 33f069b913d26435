// SPDX-License-Identifier: Apache-2.0
#include "runtime/publish/echo_reader.h"

#include <fmt/format.h>

#include <utility>

#include "runtime/base/error.h"
#include "runtime/publish/dds_entity.h"
#include "runtime/publish/dds_qos.h"
#include "runtime/publish/message_check.h"
#include "runtime/publish/message_text.h"

namespace sextant {

namespace {

constexpr int kHistory = 10;

template <typename Message>
EchoMessage echo_of(const void* sample, const std::string& topic) {
  const auto& message = *static_cast<const Message*>(sample);
  check_message(message, topic);
  return {to_text(message), to_json(message)};
}

/// How to read one kind of topic.
struct KindTraits {
  TopicType type{};
  EchoMessage (*echo)(const void* sample, const std::string& topic) = nullptr;
};

template <typename Message>
KindTraits traits() {
  return {topic_type<Message>(), &echo_of<Message>};
}

KindTraits traits_of(TopicKind kind) {
  switch (kind) {
    case TopicKind::kDetections:
      return traits<Detection3DArrayMessage>();
    case TopicKind::kObjectPose:
      return traits<PoseStampedMessage>();
    case TopicKind::kTf:
      return traits<TfMessage>();
    case TopicKind::kMarkers:
      return traits<MarkerArrayMessage>();
    case TopicKind::kAnnotated:
      return traits<ImageMessage>();
    case TopicKind::kTableEstimate:
      return traits<TableEstimateMessage>();
    case TopicKind::kDiagnostics:
      return traits<DiagnosticArrayMessage>();
    case TopicKind::kPoseEstimates:
      break;
  }
  return traits<PoseEstimateArrayMessage>();
}

}  // namespace

struct EchoReader::Impl {
  std::string topic;
  KindTraits traits{};
  std::function<void(const EchoMessage&)> receive;
  WarnFunction warn;
  DdsEntity participant, reader, waitset;
  std::uint64_t refused = 0;

  void tell(const std::string& what) const {
    if (warn) warn(topic + ": " + what);
  }

  void report_status() const {
    dds_requested_incompatible_qos_status_t incompatible{};
    check_dds(dds_get_requested_incompatible_qos_status(reader.get(), &incompatible), "cannot read a status");
    if (incompatible.total_count_change != 0) {
      tell("a publisher offers too little: " +
           policy_in_words(static_cast<dds_qos_policy_id_t>(incompatible.last_policy_id)));
    }
    dds_liveliness_changed_status_t liveliness{};
    check_dds(dds_get_liveliness_changed_status(reader.get(), &liveliness), "cannot read a status");
    if (liveliness.alive_count_change < 0) tell("a publisher has gone");
  }

  /// Takes one message; returns false when there was none. `handed_over`: it was valid and passed on.
  bool take_one(bool& handed_over) {
    handed_over = false;
    void* sample = nullptr;
    dds_sample_info_t info{};
    if (check_dds(dds_take(reader.get(), &sample, &info, 1, 1), "cannot read " + topic) == 0) return false;
    if (info.valid_data) {
      try {
        const EchoMessage message = traits.echo(sample, topic);
        receive(message);
        handed_over = true;
      } catch (const InputError& error) {
        ++refused;
        if (warn) warn(error.what());
      } catch (...) {
        dds_return_loan(reader.get(), &sample, 1);
        throw;
      }
    }
    check_dds(dds_return_loan(reader.get(), &sample, 1), "cannot return a message of " + topic);
    return true;
  }
};

EchoReader::EchoReader(const EchoReaderOptions& options, std::function<void(const EchoMessage&)> receive,
                       WarnFunction warn)
    : impl_(std::make_unique<Impl>()) {
  impl_->topic = dds_topic_name("", options.topic);
  impl_->traits = traits_of(options.kind);
  impl_->receive = std::move(receive);
  impl_->warn = std::move(warn);
  impl_->participant = create_participant(options.domain);

  const dds_entity_t participant = impl_->participant.get();
  const dds_entity_t topic = check_dds(
      dds_create_topic(participant, impl_->traits.type.descriptor, impl_->topic.c_str(), nullptr, nullptr),
      "cannot create topic " + impl_->topic);
  QosProfile profile;
  profile.reliable = false;
  profile.depth = kHistory;
  profile.type_hash = impl_->traits.type.hash;
  const QosPointer qos = make_qos(profile);
  impl_->reader = DdsEntity(dds_create_reader(participant, topic, qos.get(), nullptr),
                            "cannot create the reader of " + impl_->topic);
  impl_->waitset = DdsEntity(dds_create_waitset(participant), "cannot create a waitset");
  const dds_entity_t unread =
      check_dds(dds_create_readcondition(impl_->reader.get(), DDS_ANY_STATE), "cannot wait");
  check_dds(dds_waitset_attach(impl_->waitset.get(), unread, 0), "cannot wait");
}

EchoReader::~EchoReader() = default;

int EchoReader::poll(std::chrono::milliseconds timeout, int most) {
  dds_attach_t triggered = 0;
  check_dds(dds_waitset_wait(impl_->waitset.get(), &triggered, 1, DDS_MSECS(timeout.count())), "cannot wait");
  int handed_over = 0;
  bool valid = false;
  while (handed_over < most && impl_->take_one(valid)) handed_over += valid ? 1 : 0;
  impl_->report_status();
  return handed_over;
}

int EchoReader::matched_writers() const {
  dds_subscription_matched_status_t status{};
  check_dds(dds_get_subscription_matched_status(impl_->reader.get(), &status), "cannot read a status");
  return static_cast<int>(status.current_count);
}

std::uint64_t EchoReader::refused() const { return impl_->refused; }

}  // namespace sextant
