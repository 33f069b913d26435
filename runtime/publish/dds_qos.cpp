// SPDX-License-Identifier: Apache-2.0
#include "runtime/publish/dds_qos.h"

#include <fmt/format.h>

#include <new>

namespace sextant {

namespace {

dds_duration_t from_ms(double ms) { return static_cast<dds_duration_t>(ms * 1e6); }

}  // namespace

QosPointer make_qos(const QosProfile& profile) {
  QosPointer qos(dds_create_qos());
  if (!qos) throw std::bad_alloc();
  dds_qset_reliability(qos.get(), profile.reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT,
                       from_ms(profile.blocking_ms));
  dds_qset_durability(qos.get(),
                      profile.transient_local ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, profile.depth);
  if (profile.transient_local) {
    dds_qset_durability_service(qos.get(), 0, DDS_HISTORY_KEEP_LAST, profile.depth, DDS_LENGTH_UNLIMITED,
                                DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
  }
  if (profile.deadline_ms > 0) dds_qset_deadline(qos.get(), from_ms(profile.deadline_ms));
  if (profile.lease_ms > 0)
    dds_qset_liveliness(qos.get(), DDS_LIVELINESS_AUTOMATIC, from_ms(profile.lease_ms));
  if (profile.lifespan_ms > 0) dds_qset_lifespan(qos.get(), from_ms(profile.lifespan_ms));
  // As ROS 2 does: an orderly end of a writer is no message.
  dds_qset_writer_data_lifecycle(qos.get(), false);
  if (!profile.type_hash.empty()) {
    const std::string user_data = "typehash=" + profile.type_hash + ";";
    dds_qset_userdata(qos.get(), user_data.data(), user_data.size());
  }
  return qos;
}

std::string policy_in_words(dds_qos_policy_id_t policy) {
  switch (policy) {
    case DDS_RELIABILITY_QOS_POLICY_ID:
      return "reliability (one wants reliable, the other is best-effort)";
    case DDS_DURABILITY_QOS_POLICY_ID:
      return "durability (one wants transient-local, the other is volatile)";
    case DDS_DEADLINE_QOS_POLICY_ID:
      return "deadline (the reader wants messages more often than promised)";
    case DDS_LIVELINESS_QOS_POLICY_ID:
      return "liveliness (the reader wants a shorter lease than offered)";
    case DDS_OWNERSHIP_QOS_POLICY_ID:
      return "ownership (shared against exclusive)";
    case DDS_DATA_REPRESENTATION_QOS_POLICY_ID:
      return "data representation (we speak XCDR1)";
    default:
      return fmt::format("QoS policy {}", static_cast<int>(policy));
  }
}

}  // namespace sextant
