// SPDX-License-Identifier: Apache-2.0
// DiagnosticReport -> diagnostic_msgs/DiagnosticArray. Points into the report, which must outlive the write.
#pragma once

#include <vector>

#include "runtime/publish/diagnostics.h"
#include "runtime/publish/message_types.h"

namespace sextant {

class DiagnosticsBuilder {
 public:
  explicit DiagnosticsBuilder(const DiagnosticReport& report);
  const DiagnosticArrayMessage& message() const { return message_; }

 private:
  std::string empty_;
  std::vector<std::vector<diagnostic_msgs_msg_dds__KeyValue_>> values_;
  std::vector<diagnostic_msgs_msg_dds__DiagnosticStatus_> parts_;
  DiagnosticArrayMessage message_{};
};

}  // namespace sextant
