// SPDX-License-Identifier: Apache-2.0
// One topic and its writer, or nothing where the topic is off.
#pragma once

#include <string>

#include "runtime/publish/dds_entity.h"
#include "runtime/publish/dds_qos.h"
#include "runtime/publish/message_types.h"

namespace sextant {

class TopicWriter {
 public:
  /// Off.
  TopicWriter() = default;
  /// `topic` as dds_topic_name makes it. The participant owns the topic and must outlive the writer. Throws
  /// DeviceError.
  TopicWriter(dds_entity_t participant, const std::string& topic, const TopicType& type, QosProfile profile);

  bool on() const { return static_cast<bool>(writer_); }
  const std::string& topic() const { return topic_; }
  dds_entity_t handle() const { return writer_.get(); }

  /// Readers that match at this moment; 0 where the topic is off.
  int matched_readers() const;
  /// False: a reliable reader did not keep up within the profile's time and the message is lost. Does nothing
  /// where the topic is off. Throws DeviceError.
  bool write(const void* message) const;
  /// One line when since the last call a reader came that asks for what is not offered, else empty.
  std::string refused_reader() const;

 private:
  std::string topic_;
  DdsEntity writer_;
};

}  // namespace sextant
