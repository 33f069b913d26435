// SPDX-License-Identifier: Apache-2.0
#include "hal/dds/loopback_check.h"

#include <dds/dds.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <thread>
#include <vector>

#include "idl/dds/sensor_msgs.h"

namespace sextant {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kImages = 30;
constexpr std::size_t kBytes = std::size_t{640} * 480 * 2;
constexpr std::chrono::milliseconds kPeriod{33};
constexpr std::chrono::seconds kDiscovery{5};

/// Deletes everything under the two domains at the end.
struct Entities {
  std::vector<dds_entity_t> all;
  ~Entities() {
    for (auto it = all.rbegin(); it != all.rend(); ++it) dds_delete(*it);
  }
  dds_entity_t keep(dds_entity_t entity) {
    if (entity > 0) all.push_back(entity);
    return entity;
  }
};

std::int64_t now_ns() { return Clock::now().time_since_epoch().count(); }

}  // namespace

LoopbackResult check_dds_loopback(unsigned domain, const std::string& settings) {
  LoopbackResult result;
  const char* environment = std::getenv("CYCLONEDDS_URI");
  std::string base = environment == nullptr ? "" : environment;
  if (!settings.empty()) base += (base.empty() ? "" : ",") + settings;
  // Two domains of one process that are one on the wire: samples cannot go through memory.
  const auto config = [&](dds_domainid_t id) {
    return base + (base.empty() ? "" : ",") + "<CycloneDDS><Domain Id=\"" + std::to_string(id) +
           "\"><Discovery><ExternalDomainId>" + std::to_string(domain) +
           "</ExternalDomainId></Discovery></Domain></CycloneDDS>";
  };
  Entities entities;
  const auto problem = [&](const char* doing, dds_return_t code) {
    result.problem = std::string(doing) + ": " + dds_strretcode(code);
    return result;
  };
  dds_entity_t participants[2]{};
  for (dds_domainid_t i = 0; i < 2; ++i) {
    const dds_domainid_t id = 40000 + i;
    const dds_entity_t made = entities.keep(dds_create_domain(id, config(id).c_str()));
    if (made < 0) return problem("cannot start DDS with the settings in CYCLONEDDS_URI", made);
    participants[i] = entities.keep(dds_create_participant(id, nullptr, nullptr));
    if (participants[i] < 0) return problem("cannot join the domain", participants[i]);
  }
  const std::string topic = "rt/sextant_doctor_" + std::to_string(::getpid());
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_BEST_EFFORT, DDS_MSECS(100));
  dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 5);
  dds_entity_t topics[2]{};
  for (int i = 0; i < 2; ++i) {
    topics[i] =
        dds_create_topic(participants[i], &sensor_msgs_msg_dds__Image__desc, topic.c_str(), nullptr, nullptr);
  }
  const dds_entity_t writer = dds_create_writer(participants[0], topics[0], qos, nullptr);
  const dds_entity_t reader = dds_create_reader(participants[1], topics[1], qos, nullptr);
  dds_delete_qos(qos);
  if (writer < 0) return problem("cannot write", writer);
  if (reader < 0) return problem("cannot read", reader);

  const auto start = Clock::now();
  dds_publication_matched_status_t matched{};
  while (matched.current_count == 0 && Clock::now() - start < kDiscovery) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    dds_get_publication_matched_status(writer, &matched);
  }
  if (matched.current_count == 0) {
    result.problem = "reader and writer did not find each other within 5 s";
    return result;
  }
  result.discovery_ms = std::chrono::duration<double, std::milli>(Clock::now() - start).count();

  std::vector<double> ages_ms;
  const auto take = [&] {
    for (;;) {
      void* sample = nullptr;
      dds_sample_info_t info{};
      if (dds_take(reader, &sample, &info, 1, 1) <= 0) return;
      if (info.valid_data) {
        const auto& stamp = static_cast<const sensor_msgs_msg_dds__Image_*>(sample)->header.stamp;
        const std::int64_t sent = std::int64_t{stamp.sec} * 1'000'000'000 + stamp.nanosec;
        ages_ms.push_back(1e-6 * static_cast<double>(now_ns() - sent));
      }
      dds_return_loan(reader, &sample, 1);
    }
  };
  std::vector<std::uint8_t> data(kBytes, 7);
  std::string text = "16UC1";
  std::string frame;
  sensor_msgs_msg_dds__Image_ image{};
  image.width = 640;
  image.height = 480;
  image.step = 1280;
  image.encoding = text.data();
  image.header.frame_id = frame.data();
  image.data = {static_cast<std::uint32_t>(kBytes), static_cast<std::uint32_t>(kBytes), data.data(), false};
  for (int i = 0; i < kImages; ++i) {
    const std::int64_t ns = now_ns();
    image.header.stamp = {static_cast<std::int32_t>(ns / 1'000'000'000),
                          static_cast<std::uint32_t>(ns % 1'000'000'000)};
    if (dds_write(writer, &image) == DDS_RETCODE_OK) ++result.sent;
    const auto next = Clock::now() + kPeriod;
    while (Clock::now() < next) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      take();
    }
  }
  result.received = static_cast<int>(ages_ms.size());
  if (!ages_ms.empty()) {
    std::nth_element(ages_ms.begin(), ages_ms.begin() + static_cast<std::ptrdiff_t>(ages_ms.size() / 2),
                     ages_ms.end());
    result.median_ms = ages_ms[ages_ms.size() / 2];
  }
  return result;
}

}  // namespace sextant
