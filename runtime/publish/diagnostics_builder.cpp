// SPDX-License-Identifier: Apache-2.0
#include "runtime/publish/diagnostics_builder.h"

#include "runtime/publish/message_parts.h"

namespace sextant {

DiagnosticsBuilder::DiagnosticsBuilder(const DiagnosticReport& report) {
  message_.header = {to_time(report.at), borrowed(empty_)};
  values_.reserve(report.parts.size());
  for (const DiagnosticStatus& part : report.parts) {
    auto& values = values_.emplace_back();
    for (const auto& [key, value] : part.values) values.push_back({borrowed(key), borrowed(value)});
    diagnostic_msgs_msg_dds__DiagnosticStatus_ status{};
    status.level = static_cast<std::uint8_t>(part.level);
    status.name = borrowed(part.name);
    status.message = borrowed(part.message);
    status.hardware_id = borrowed(report.hardware_id);
    status.values = borrowed_sequence<decltype(status.values)>(values);
    parts_.push_back(status);
  }
  message_.status = borrowed_sequence<decltype(message_.status)>(parts_);
}

}  // namespace sextant
