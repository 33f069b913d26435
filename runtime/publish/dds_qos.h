// SPDX-License-Identifier: Apache-2.0
// Quality of service of our endpoints. The rule: our writers are reliable (a best-effort writer gives a
// reliable reader nothing), our readers best-effort; keep-last always, so nothing grows without bound.
#pragma once

#include <dds/dds.h>

#include <memory>
#include <string>

namespace sextant {

/// What differs between our topics.
struct QosProfile {
  bool reliable = true;
  bool transient_local = false;  ///< a late joiner gets the last `depth` messages
  int depth = 10;                ///< keep-last history
  double deadline_ms = 0;        ///< promise of a message at least this often; 0: none
  double lease_ms = 0;           ///< a killed writer is noticed after this time; 0: after 10 s
  double lifespan_ms = 0;        ///< older messages are not delivered; 0: never too old
  double blocking_ms = 100;      ///< how long a write may wait for a slow reliable reader before it gives up
  std::string type_hash{};       ///< REP-2011 "RIHS01_...", told to ROS 2 in USER_DATA; empty: not told
};

struct QosDeleter {
  void operator()(dds_qos_t* qos) const { dds_delete_qos(qos); }
};
using QosPointer = std::unique_ptr<dds_qos_t, QosDeleter>;

/// The profile in Cyclone's form.
QosPointer make_qos(const QosProfile& profile);

/// What a QoS policy that two endpoints disagree on means for people, e.g. "liveliness lease".
std::string policy_in_words(dds_qos_policy_id_t policy);

}  // namespace sextant
