// SPDX-License-Identifier: Apache-2.0
#include "hal/dds/subscription.h"

#include <algorithm>
#include <cctype>
#include <new>

#include "runtime/base/error.h"

namespace sextant {
namespace {

constexpr unsigned kHighestDomain = 230;  ///< higher ones have no UDP ports
constexpr std::chrono::milliseconds kLongestPatience{30000};

dds_return_t check(dds_return_t code, const std::string& doing, const std::string& advice = "") {
  if (code < 0) throw DeviceError("DDS", doing + ": " + dds_strretcode(code), advice);
  return code;
}

struct QosDeleter {
  void operator()(dds_qos_t* qos) const { dds_delete_qos(qos); }
};

std::unique_ptr<dds_qos_t, QosDeleter> qos_of(const SubscriptionOptions& options) {
  std::unique_ptr<dds_qos_t, QosDeleter> qos(dds_create_qos());
  if (!qos) throw std::bad_alloc();
  dds_qset_reliability(qos.get(), options.latched ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT,
                       DDS_MSECS(100));
  dds_qset_durability(qos.get(), options.latched ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, options.depth);
  if (!options.type_hash.empty()) {
    const std::string user_data = "typehash=" + options.type_hash + ";";
    dds_qset_userdata(qos.get(), user_data.data(), user_data.size());
  }
  return qos;
}

}  // namespace

bool is_ros_topic(const std::string& name) {
  if (name.empty() || name.size() > 200 || name.back() == '/') return false;
  bool token_starts = true;
  for (const char c : name) {
    const auto u = static_cast<unsigned char>(c);
    if (token_starts ? !(std::isalpha(u) || c == '_') : !(std::isalnum(u) || c == '_' || c == '/'))
      return false;
    token_starts = c == '/';
  }
  return true;
}

DdsParticipant::DdsParticipant(unsigned domain) {
  if (domain > kHighestDomain) {
    throw UsageError("DDS domain " + std::to_string(domain) + " does not exist", "use 0..230");
  }
  handle_ =
      check(dds_create_participant(domain, nullptr, nullptr), "cannot join domain " + std::to_string(domain),
            "check the network and the file or text in CYCLONEDDS_URI (config/cyclonedds.xml is for one "
            "machine)");
}

DdsParticipant::~DdsParticipant() { dds_delete(handle_); }

Subscription::Subscription(std::shared_ptr<const DdsParticipant> participant, SubscriptionOptions options)
    : participant_(std::move(participant)),
      options_(std::move(options)),
      last_message_(options_.now()),
      patience_(options_.starved_after) {
  if (!is_ros_topic(options_.topic)) {
    throw UsageError("\"" + options_.topic.substr(0, 100) + "\" is no topic name",
                     "use letters, digits, _ and /, not starting with / or a digit");
  }
  const dds_entity_t owner = participant_->get();
  topic_ = check(dds_create_topic(owner, options_.type, ("rt/" + options_.topic).c_str(), nullptr, nullptr),
                 "cannot create topic " + options_.topic);
  waitset_ = check(dds_create_waitset(owner), "cannot create a waitset");
  guard_ = check(dds_create_guardcondition(owner), "cannot create a guard condition");
  check(dds_waitset_attach(waitset_, guard_, 0), "cannot wait");
  create_reader();
}

Subscription::~Subscription() {
  for (const dds_entity_t entity : {waitset_, guard_, reader_, topic_}) {
    if (entity > 0) dds_delete(entity);
  }
}

void Subscription::create_reader() {
  const auto qos = qos_of(options_);
  const dds_entity_t reader = check(dds_create_reader(participant_->get(), topic_, qos.get(), nullptr),
                                    "cannot create the reader of " + options_.topic);
  if (reader_ > 0) {
    dds_waitset_detach(waitset_, read_condition_);
    dds_delete(reader_);
  }
  reader_ = reader;
  read_condition_ = check(dds_create_readcondition(reader_, DDS_ANY_STATE), "cannot wait");
  check(dds_waitset_attach(waitset_, read_condition_, 0), "cannot wait");
}

int Subscription::wait_and_take(std::chrono::milliseconds timeout,
                                const std::function<void(const void* sample)>& visit) {
  dds_attach_t triggered = 0;
  check(dds_waitset_wait(waitset_, &triggered, 1, DDS_MSECS(timeout.count())), "cannot wait");
  int taken = 0;
  for (;;) {
    void* sample = nullptr;
    dds_sample_info_t info{};
    if (check(dds_take(reader_, &sample, &info, 1, 1), "cannot read " + options_.topic) == 0) break;
    if (info.valid_data) {
      visit(sample);
      ++taken;
    }
    check(dds_return_loan(reader_, &sample, 1), "cannot return a message of " + options_.topic);
    if (taken >= options_.depth) break;  // whoever floods us does not keep us here
  }
  watch(taken);
  return taken;
}

void Subscription::watch(int taken) {
  const auto now = options_.now();
  if (taken > 0) {
    heard_ = true;
    last_message_ = now;
    patience_ = options_.starved_after;
    return;
  }
  if (options_.latched || options_.starved_after.count() == 0) return;
  if (!heard_ && matched_writers() > 0) {
    heard_ = true;
    last_message_ = now;  // its time counts from here
  }
  if (!heard_ || now - last_message_ < patience_) return;
  create_reader();
  ++recreated_;
  last_message_ = now;
  patience_ = std::min(2 * patience_, kLongestPatience);
}

void Subscription::wake() { dds_set_guardcondition(guard_, true); }

int Subscription::matched_writers() const {
  dds_subscription_matched_status_t status{};
  check(dds_get_subscription_matched_status(reader_, &status), "cannot read a status");
  return static_cast<int>(status.current_count);
}

std::string Subscription::condition() const {
  dds_requested_incompatible_qos_status_t incompatible{};
  if (matched_writers() > 0) return {};
  if (dds_get_requested_incompatible_qos_status(reader_, &incompatible) == DDS_RETCODE_OK &&
      incompatible.total_count > 0) {
    return "a publisher of " + options_.topic + " offers too little (QoS policy " +
           std::to_string(incompatible.last_policy_id) +
           (options_.latched ? "; it must be transient-local)" : ")");
  }
  return "nobody publishes " + options_.topic;
}

}  // namespace sextant
