// SPDX-License-Identifier: Apache-2.0
// One topic that we read: a best-effort reader (our rule: readers never ask a camera driver for resends), its
// waitset, and a watchdog that makes the reader anew when nothing comes although something should. Damaged
// packets can leave a reader starved for good while a fresh one works at once (measured with Cyclone 0.10).
#pragma once

#include <dds/dds.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

namespace sextant {

/// Owns the participant of a domain; subscriptions share it.
class DdsParticipant {
 public:
  /// domain 0..230. Throws UsageError, or DeviceError where DDS cannot start.
  explicit DdsParticipant(unsigned domain);
  ~DdsParticipant();
  DdsParticipant(const DdsParticipant&) = delete;
  DdsParticipant& operator=(const DdsParticipant&) = delete;
  dds_entity_t get() const { return handle_; }

 private:
  dds_entity_t handle_ = 0;
};

/// What to read.
struct SubscriptionOptions {
  std::string topic;  ///< as ROS 2 names it, without a leading "/"
  const dds_topic_descriptor_t* type = nullptr;
  std::string type_hash;  ///< REP-2011, told to ROS 2
  int depth = 5;          ///< keep-last history
  bool latched = false;   ///< transient-local and reliable: tf_static and the like
  /// Without a message for so long although a writer is there (or was), the reader is made anew; every
  /// further time in vain doubles the wait, up to 30 s. 0: never. Latched topics are not watched: they are
  /// silent.
  std::chrono::milliseconds starved_after{2000};
  /// The watchdog's clock; tests inject theirs.
  std::function<std::chrono::steady_clock::time_point()> now = [] {
    return std::chrono::steady_clock::now();
  };
};

/// One thread calls wait_and_take(); wake() may come from any.
class Subscription {
 public:
  /// Throws UsageError for an impossible name, DeviceError where DDS refuses.
  Subscription(std::shared_ptr<const DdsParticipant> participant, SubscriptionOptions options);
  ~Subscription();
  Subscription(const Subscription&) = delete;
  Subscription& operator=(const Subscription&) = delete;

  /// Waits for messages up to the timeout and shows each to `visit`, oldest first. The sample is valid during
  /// the call only; visit must not throw. Returns their number.
  int wait_and_take(std::chrono::milliseconds timeout, const std::function<void(const void* sample)>& visit);
  /// Makes a waiting wait_and_take() return, now and ever after.
  void wake();

  int matched_writers() const;
  /// How often the reader was made anew.
  std::uint64_t recreated() const { return recreated_; }
  /// What is wrong, for people: no publisher, an incompatible one, silence; empty: nothing.
  std::string condition() const;
  const std::string& topic() const { return options_.topic; }

 private:
  void create_reader();
  void watch(int taken);

  std::shared_ptr<const DdsParticipant> participant_;
  SubscriptionOptions options_;
  dds_entity_t topic_ = 0;
  dds_entity_t reader_ = 0;
  dds_entity_t read_condition_ = 0;
  dds_entity_t guard_ = 0;
  dds_entity_t waitset_ = 0;
  bool heard_ = false;  ///< there was a message or a writer once
  std::chrono::steady_clock::time_point last_message_;
  std::chrono::milliseconds patience_;
  std::uint64_t recreated_ = 0;
};

/// True for a relative ROS 2 name: letters, digits, "_" in tokens separated by "/", no token starting with a
/// digit, 1..200 characters.
bool is_ros_topic(const std::string& name);

}  // namespace sextant
