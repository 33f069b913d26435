// SPDX-License-Identifier: Apache-2.0
#include "tests/interop/fast_dds_peer.h"

// Fast DDS's own headers do not stand our warnings.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wdeprecated-declarations"
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#pragma GCC diagnostic pop

#include <atomic>
#include <cstring>
#include <mutex>
#include <stdexcept>

namespace sextant {

namespace {

using namespace eprosima::fastdds::dds;
using eprosima::fastrtps::Duration_t;
using eprosima::fastrtps::rtps::SerializedPayload_t;
using Bytes = FastDdsPeer::Bytes;

constexpr std::uint32_t kLargestMessage = 16U << 20;

/// Any type, as its serialised bytes.
class RawType : public TopicDataType {
 public:
  explicit RawType(const std::string& name) {
    setName(name.c_str());
    m_typeSize = kLargestMessage;
    m_isGetKeyDefined = false;
    auto_fill_type_object(false);  // ROS 2 endpoints send none
    auto_fill_type_information(false);
  }
  bool serialize(void* data, SerializedPayload_t* payload) override {
    const Bytes& bytes = *static_cast<Bytes*>(data);
    if (bytes.size() > payload->max_size) return false;
    std::memcpy(payload->data, bytes.data(), bytes.size());
    payload->length = static_cast<std::uint32_t>(bytes.size());
    payload->encapsulation = bytes.size() > 1 && bytes[1] == 0 ? CDR_BE : CDR_LE;
    return true;
  }
  bool deserialize(SerializedPayload_t* payload, void* data) override {
    static_cast<Bytes*>(data)->assign(payload->data, payload->data + payload->length);
    return true;
  }
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override {
    return [data] { return static_cast<std::uint32_t>(static_cast<Bytes*>(data)->size()); };
  }
  void* createData() override { return new Bytes; }
  void deleteData(void* data) override { delete static_cast<Bytes*>(data); }
  bool getKey(void*, eprosima::fastrtps::rtps::InstanceHandle_t*, bool) override { return false; }
};

double ms_of(const Duration_t& duration) {
  return duration == eprosima::fastrtps::c_TimeInfinite ? 0 : static_cast<double>(duration.to_ns()) / 1e6;
}
Duration_t duration_of(double ms) {
  return ms > 0 ? Duration_t(static_cast<long double>(ms / 1000)) : eprosima::fastrtps::c_TimeInfinite;
}

struct Discovery : DomainParticipantListener {
  void on_publisher_discovery(DomainParticipant*,
                              eprosima::fastrtps::rtps::WriterDiscoveryInfo&& info) override {
    if (info.status != eprosima::fastrtps::rtps::WriterDiscoveryInfo::DISCOVERED_WRITER) return;
    DiscoveredWriter writer;
    writer.type_name = info.info.typeName().to_string();
    const auto& qos = info.info.m_qos;
    writer.user_data.assign(qos.m_userData.begin(), qos.m_userData.end());
    writer.reliable = qos.m_reliability.kind == RELIABLE_RELIABILITY_QOS;
    writer.transient_local = qos.m_durability.kind == TRANSIENT_LOCAL_DURABILITY_QOS;
    writer.deadline_ms = ms_of(qos.m_deadline.period);
    writer.lease_ms = ms_of(qos.m_liveliness.lease_duration);
    writer.lifespan_ms = ms_of(qos.m_lifespan.duration);
    const std::lock_guard lock(mutex);
    writers[info.info.topicName().to_string()] = writer;
  }
  mutable std::mutex mutex;
  std::map<std::string, DiscoveredWriter> writers;
};

struct Watcher : DataReaderListener {
  void on_liveliness_changed(DataReader*,
                             const eprosima::fastrtps::LivelinessChangedStatus& status) override {
    alive = status.alive_count;
  }
  void on_requested_deadline_missed(
      DataReader*, const eprosima::fastrtps::RequestedDeadlineMissedStatus& status) override {
    missed = static_cast<int>(status.total_count);
  }
  void on_requested_incompatible_qos(DataReader*, const RequestedIncompatibleQosStatus& status) override {
    incompatible = static_cast<int>(status.total_count);
  }
  void on_subscription_matched(DataReader*, const SubscriptionMatchedStatus& status) override {
    matched = status.current_count;
  }
  std::atomic<int> alive = 0, missed = 0, incompatible = 0, matched = 0;
};

template <typename Pointer>
Pointer needed(Pointer pointer, const char* what) {
  if (pointer == nullptr) throw std::runtime_error(std::string("Fast DDS: no ") + what);
  return pointer;
}

}  // namespace

struct FastDdsPeer::Impl {
  Discovery discovery;
  DomainParticipant* participant = nullptr;
  Subscriber* subscriber = nullptr;
  Publisher* publisher = nullptr;
  std::map<std::string, Topic*> topics;
  std::map<std::string, DataReader*> readers;
  std::map<std::string, std::unique_ptr<Watcher>> watchers;
  std::map<std::string, DataWriter*> writers;

  Topic* topic(const std::string& name, const std::string& type_name) {
    Topic*& found = topics[name];
    if (found == nullptr) {
      TypeSupport(new RawType(type_name)).register_type(participant);
      found = needed(participant->create_topic(name, type_name, TOPIC_QOS_DEFAULT), "topic");
    }
    return found;
  }
};

FastDdsPeer::FastDdsPeer(unsigned domain) : impl_(std::make_unique<Impl>()) {
  DomainParticipantQos qos;
  auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
  udp->interfaceWhiteList = {"127.0.0.1"};
  udp->maxInitialPeersRange = 33;
  qos.transport().use_builtin_transports = false;
  qos.transport().user_transports.push_back(udp);
  auto& builtin = qos.wire_protocol().builtin;
  eprosima::fastrtps::rtps::Locator_t self;
  eprosima::fastrtps::rtps::IPLocator::setIPv4(self, "127.0.0.1");
  builtin.initialPeersList.push_back(self);
  builtin.discovery_config.leaseDuration_announcementperiod = Duration_t(0.25L);
  impl_->participant = needed(DomainParticipantFactory::get_instance()->create_participant(
                                  domain, qos, &impl_->discovery, StatusMask::none()),
                              "participant");
  impl_->subscriber = needed(impl_->participant->create_subscriber(SUBSCRIBER_QOS_DEFAULT), "subscriber");
  impl_->publisher = needed(impl_->participant->create_publisher(PUBLISHER_QOS_DEFAULT), "publisher");
}

FastDdsPeer::~FastDdsPeer() {
  impl_->participant->delete_contained_entities();
  DomainParticipantFactory::get_instance()->delete_participant(impl_->participant);
}

void FastDdsPeer::subscribe(const std::string& topic, const std::string& type_name, const FastDdsQos& qos) {
  DataReaderQos reader;
  reader.reliability().kind = qos.reliable ? RELIABLE_RELIABILITY_QOS : BEST_EFFORT_RELIABILITY_QOS;
  reader.durability().kind = qos.transient_local ? TRANSIENT_LOCAL_DURABILITY_QOS : VOLATILE_DURABILITY_QOS;
  reader.history().kind = KEEP_LAST_HISTORY_QOS;
  reader.history().depth = qos.depth;
  reader.deadline().period = duration_of(qos.deadline_ms);
  reader.liveliness().lease_duration = duration_of(qos.lease_ms);
  reader.endpoint().history_memory_policy = eprosima::fastrtps::rtps::DYNAMIC_RESERVE_MEMORY_MODE;
  auto& watcher = impl_->watchers[topic] = std::make_unique<Watcher>();
  impl_->readers[topic] = needed(
      impl_->subscriber->create_datareader(impl_->topic(topic, type_name), reader, watcher.get()), "reader");
}

std::optional<Bytes> FastDdsPeer::take(const std::string& topic, std::chrono::milliseconds timeout) {
  DataReader* reader = impl_->readers.at(topic);
  const auto end = std::chrono::steady_clock::now() + timeout;
  do {
    Bytes bytes;
    SampleInfo info;
    while (reader->take_next_sample(&bytes, &info) == ReturnCode_t::RETCODE_OK) {
      if (info.valid_data) return bytes;
    }
    reader->wait_for_unread_message(Duration_t(0.02L));
  } while (std::chrono::steady_clock::now() < end);
  return std::nullopt;
}

int FastDdsPeer::matched_writers(const std::string& topic) const {
  return impl_->watchers.at(topic)->matched;
}

ReaderEvents FastDdsPeer::events(const std::string& topic) const {
  const Watcher& watcher = *impl_->watchers.at(topic);
  return {watcher.alive, watcher.missed, watcher.incompatible};
}

void FastDdsPeer::advertise(const std::string& topic, const std::string& type_name, const FastDdsQos& qos) {
  DataWriterQos writer;
  writer.reliability().kind = qos.reliable ? RELIABLE_RELIABILITY_QOS : BEST_EFFORT_RELIABILITY_QOS;
  writer.durability().kind = qos.transient_local ? TRANSIENT_LOCAL_DURABILITY_QOS : VOLATILE_DURABILITY_QOS;
  writer.history().kind = KEEP_LAST_HISTORY_QOS;
  writer.history().depth = qos.depth;
  writer.publish_mode().kind = SYNCHRONOUS_PUBLISH_MODE;
  writer.endpoint().history_memory_policy = eprosima::fastrtps::rtps::DYNAMIC_RESERVE_MEMORY_MODE;
  impl_->writers[topic] =
      needed(impl_->publisher->create_datawriter(impl_->topic(topic, type_name), writer), "writer");
}

bool FastDdsPeer::publish(const std::string& topic, const Bytes& bytes) {
  Bytes copy = bytes;
  return impl_->writers.at(topic)->write(&copy);
}

int FastDdsPeer::matched_readers(const std::string& topic) const {
  PublicationMatchedStatus status;
  impl_->writers.at(topic)->get_publication_matched_status(status);
  return status.current_count;
}

std::map<std::string, DiscoveredWriter> FastDdsPeer::discovered() const {
  const std::lock_guard lock(impl_->discovery.mutex);
  return impl_->discovery.writers;
}

}  // namespace sextant
