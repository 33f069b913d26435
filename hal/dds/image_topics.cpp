// SPDX-License-Identifier: Apache-2.0
#include "hal/dds/image_topics.h"

#include <algorithm>
#include <set>
#include <thread>

#include "hal/dds/subscription.h"
#include "runtime/base/error.h"

namespace sextant {
namespace {

constexpr char kImageType[] = "sensor_msgs::msg::dds_::Image_";

/// What text from the wire may be shown.
std::string printable(std::string text) {
  text.resize(std::min<std::size_t>(text.size(), 200));
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return text;
}

}  // namespace

std::vector<std::string> list_image_topics(unsigned domain, std::chrono::milliseconds listen) {
  const DdsParticipant participant(domain);
  const dds_entity_t reader =
      dds_create_reader(participant.get(), DDS_BUILTIN_TOPIC_DCPSPUBLICATION, nullptr, nullptr);
  if (reader < 0) throw DeviceError("DDS", std::string("cannot read discovery: ") + dds_strretcode(reader));
  // Discovery has no end: what answered within the time counts.
  std::this_thread::sleep_for(listen);
  std::set<std::string> names;
  for (;;) {
    void* sample = nullptr;
    dds_sample_info_t info{};
    if (dds_take(reader, &sample, &info, 1, 1) <= 0) break;
    if (info.valid_data && info.instance_state == DDS_IST_ALIVE) {
      const auto& endpoint = *static_cast<const dds_builtintopic_endpoint_t*>(sample);
      const std::string topic = endpoint.topic_name == nullptr ? "" : endpoint.topic_name;
      if (endpoint.type_name != nullptr && std::string(endpoint.type_name) == kImageType &&
          topic.rfind("rt/", 0) == 0) {
        names.insert(printable(topic.substr(3)));
      }
    }
    dds_return_loan(reader, &sample, 1);
  }
  return {names.begin(), names.end()};
}

}  // namespace sextant
