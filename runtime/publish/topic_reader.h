// SPDX-License-Identifier: Apache-2.0
// One topic, its reader and what it takes to wait for messages; the counterpart of topic_writer.h.
#pragma once

#include <chrono>
#include <functional>
#include <string>

#include "runtime/publish/dds_entity.h"
#include "runtime/publish/dds_qos.h"
#include "runtime/publish/message_types.h"

namespace sextant {

/// Not thread-safe but for matched_writers().
class TopicReader {
 public:
  /// Shown one message; it is valid during the call only.
  using Visit = std::function<void(const void* message)>;

  TopicReader() = default;
  /// `topic` as dds_topic_name makes it. The participant must outlive the reader. Throws DeviceError.
  TopicReader(dds_entity_t participant, const std::string& topic, const TopicType& type, QosProfile profile);

  const std::string& topic() const { return topic_; }
  dds_entity_t handle() const { return reader_.get(); }

  /// Returns when there is something to take, or after the timeout.
  void wait(std::chrono::milliseconds timeout) const;
  /// Takes the oldest sample and shows it to `visit`, unless it only says that a writer has gone. False:
  /// there was none. What `visit` throws passes through.
  bool take(const Visit& visit) const;
  /// Writers that match at this moment.
  int matched_writers() const;

 private:
  std::string topic_;
  DdsEntity reader_, waitset_;
};

}  // namespace sextant
