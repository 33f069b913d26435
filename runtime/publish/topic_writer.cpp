// SPDX-License-Identifier: Apache-2.0
#include "runtime/publish/topic_writer.h"

#include <fmt/format.h>

#include <utility>

namespace sextant {

TopicWriter::TopicWriter(dds_entity_t participant, const std::string& topic, const TopicType& type,
                         QosProfile profile)
    : topic_(topic) {
  profile.type_hash = type.hash;
  const QosPointer qos = make_qos(profile);
  const dds_entity_t handle =
      check_dds(dds_create_topic(participant, type.descriptor, topic.c_str(), nullptr, nullptr),
                "cannot create topic " + topic, "another topic of that name may have another type");
  writer_ = DdsEntity(dds_create_writer(participant, handle, qos.get(), nullptr),
                      "cannot create the writer of " + topic);
}

int TopicWriter::matched_readers() const {
  if (!on()) return 0;
  dds_publication_matched_status_t status{};
  check_dds(dds_get_publication_matched_status(writer_.get(), &status), "cannot read a status");
  return static_cast<int>(status.current_count);
}

bool TopicWriter::write(const void* message) const {
  if (!on()) return true;
  const dds_return_t code = dds_write(writer_.get(), message);
  if (code == DDS_RETCODE_TIMEOUT) return false;
  check_dds(code, "cannot write " + topic_);
  return true;
}

std::string TopicWriter::refused_reader() const {
  if (!on()) return "";
  dds_offered_incompatible_qos_status_t status{};
  check_dds(dds_get_offered_incompatible_qos_status(writer_.get(), &status), "cannot read a status");
  if (status.total_count_change == 0) return "";
  return fmt::format("{}: a reader asks for what is not offered and gets nothing: {}", topic_,
                     policy_in_words(static_cast<dds_qos_policy_id_t>(status.last_policy_id)));
}

}  // namespace sextant
