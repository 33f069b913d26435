// SPDX-License-Identifier: Apache-2.0
#include "runtime/publish/topic_reader.h"

#include <utility>

namespace sextant {

namespace {

/// A sample on loan from a reader.
struct Loan {
  dds_entity_t reader;
  void* sample = nullptr;
  dds_sample_info_t info{};

  explicit Loan(dds_entity_t of) : reader(of) {}
  ~Loan() {
    if (sample != nullptr) dds_return_loan(reader, &sample, 1);
  }
  Loan(const Loan&) = delete;
  Loan& operator=(const Loan&) = delete;
};

}  // namespace

TopicReader::TopicReader(dds_entity_t participant, const std::string& topic, const TopicType& type,
                         QosProfile profile)
    : topic_(topic) {
  profile.type_hash = type.hash;
  const QosPointer qos = make_qos(profile);
  const dds_entity_t handle =
      check_dds(dds_create_topic(participant, type.descriptor, topic.c_str(), nullptr, nullptr),
                "cannot create topic " + topic, "another topic of that name may have another type");
  reader_ = DdsEntity(dds_create_reader(participant, handle, qos.get(), nullptr),
                      "cannot create the reader of " + topic);
  waitset_ = DdsEntity(dds_create_waitset(participant), "cannot create a waitset");
  const dds_entity_t unread =
      check_dds(dds_create_readcondition(reader_.get(), DDS_ANY_STATE), "cannot wait for " + topic);
  check_dds(dds_waitset_attach(waitset_.get(), unread, 0), "cannot wait for " + topic);
}

void TopicReader::wait(std::chrono::milliseconds timeout) const {
  dds_attach_t triggered = 0;
  check_dds(dds_waitset_wait(waitset_.get(), &triggered, 1, DDS_MSECS(timeout.count())),
            "cannot wait for " + topic_);
}

bool TopicReader::take(const Visit& visit) const {
  Loan loan(reader_.get());
  if (check_dds(dds_take(reader_.get(), &loan.sample, &loan.info, 1, 1), "cannot read " + topic_) == 0)
    return false;
  if (loan.info.valid_data) visit(loan.sample);
  return true;
}

int TopicReader::matched_writers() const {
  dds_subscription_matched_status_t status{};
  check_dds(dds_get_subscription_matched_status(reader_.get(), &status), "cannot read a status");
  return static_cast<int>(status.current_count);
}

}  // namespace sextant
