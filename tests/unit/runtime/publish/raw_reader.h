// SPDX-License-Identifier: Apache-2.0
// A reader as a stranger would write it: any QoS, straight on Cyclone's C API.
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <thread>

#include "runtime/publish/dds_entity.h"
#include "runtime/publish/dds_qos.h"

namespace sextant {

struct RawReader {
  DdsEntity participant;
  dds_entity_t reader = 0;

  RawReader(unsigned domain, const dds_topic_descriptor_t& type, const std::string& topic,
            const dds_qos_t* qos)
      : participant(create_participant(domain)) {
    const dds_entity_t t =
        check_dds(dds_create_topic(participant.get(), &type, topic.c_str(), nullptr, nullptr), "topic");
    reader = check_dds(dds_create_reader(participant.get(), t, qos, nullptr), "reader");
  }

  int matched() const {
    dds_subscription_matched_status_t status{};
    check_dds(dds_get_subscription_matched_status(reader, &status), "status");
    return static_cast<int>(status.current_count);
  }

  /// Takes everything there is; returns the number of valid messages.
  int take() const {
    int valid = 0;
    void* sample = nullptr;
    dds_sample_info_t info{};
    while (check_dds(dds_take(reader, &sample, &info, 1, 1), "take") > 0) {
      valid += info.valid_data ? 1 : 0;
      dds_return_loan(reader, &sample, 1);
      sample = nullptr;
    }
    return valid;
  }
};

/// Waits up to 20 s for something that must come.
inline bool eventually(const std::function<bool()>& condition) {
  for (int i = 0; i < 2000; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

}  // namespace sextant
