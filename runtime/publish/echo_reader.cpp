// SPDX-License-Identifier: Apache-2.0
#include "runtime/publish/echo_reader.h"

#include <fmt/format.h>

#include <utility>

#include "runtime/base/error.h"
#include "runtime/publish/message_check.h"
#include "runtime/publish/message_text.h"
#include "runtime/publish/topic_reader.h"

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
    case TopicKind::kCommand:
      return traits<CommandMessage>();
    case TopicKind::kCommandAnswer:
      return traits<CommandAnswerMessage>();
    case TopicKind::kPoseEstimates:
      break;
  }
  return traits<PoseEstimateArrayMessage>();
}

}  // namespace

struct EchoReader::Impl {
  KindTraits traits{};
  std::function<void(const EchoMessage&)> receive;
  WarnFunction warn;
  DdsEntity participant;
  TopicReader reader;
  std::uint64_t refused = 0;

  void tell(const std::string& what) const {
    if (warn) warn(reader.topic() + ": " + what);
  }

  void report_status() const {
    dds_requested_incompatible_qos_status_t incompatible{};
    check_dds(dds_get_requested_incompatible_qos_status(reader.handle(), &incompatible),
              "cannot read a status");
    if (incompatible.total_count_change != 0) {
      tell("a publisher offers too little: " +
           policy_in_words(static_cast<dds_qos_policy_id_t>(incompatible.last_policy_id)));
    }
    dds_liveliness_changed_status_t liveliness{};
    check_dds(dds_get_liveliness_changed_status(reader.handle(), &liveliness), "cannot read a status");
    if (liveliness.alive_count_change < 0) tell("a publisher has gone");
  }

  /// Hands the message over; false: it was refused.
  bool hand_over(const void* sample) {
    try {
      receive(traits.echo(sample, reader.topic()));
      return true;
    } catch (const InputError& error) {
      ++refused;
      if (warn) warn(error.what());
      return false;
    }
  }
};

EchoReader::EchoReader(const EchoReaderOptions& options, std::function<void(const EchoMessage&)> receive,
                       WarnFunction warn)
    : impl_(std::make_unique<Impl>()) {
  impl_->traits = traits_of(options.kind);
  impl_->receive = std::move(receive);
  impl_->warn = std::move(warn);
  const std::string topic = dds_topic_name("", options.topic);
  impl_->participant = create_participant(options.domain);
  QosProfile profile;
  profile.reliable = false;
  profile.depth = kHistory;
  impl_->reader = TopicReader(impl_->participant.get(), topic, impl_->traits.type, profile);
}

EchoReader::~EchoReader() = default;

int EchoReader::poll(std::chrono::milliseconds timeout, int most) {
  impl_->reader.wait(timeout);
  int handed_over = 0;
  const auto count = [&](const void* sample) { handed_over += impl_->hand_over(sample) ? 1 : 0; };
  while (handed_over < most && impl_->reader.take(count)) {
  }
  impl_->report_status();
  return handed_over;
}

int EchoReader::matched_writers() const { return impl_->reader.matched_writers(); }

std::uint64_t EchoReader::refused() const { return impl_->refused; }

}  // namespace sextant
