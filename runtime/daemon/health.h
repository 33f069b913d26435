// SPDX-License-Identifier: Apache-2.0
// How the daemon is, from what its parts counted: the content of the diagnostics topic.
#pragma once

#include <array>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "hal/frame_source.h"
#include "runtime/daemon/latency_window.h"
#include "runtime/daemon/pipeline.h"
#include "runtime/publish/diagnostics.h"
#include "runtime/publish/publisher.h"

namespace sextant {

/// What is watched from outside of it.
struct HealthInput {
  PipelineStatistics pipeline;
  SourceStatistics source;
  SourceState source_state = SourceState::kRunning;
  std::string source_condition{};
  PublisherStatistics publisher;
  int readers = 0;
  double max_age_ms = 0;
  std::vector<std::pair<std::string, double>> temperatures_celsius{};
};

/// Collects the frames' stories between two reports. One thread at a time.
class Health {
 public:
  explicit Health(std::string hardware_id) : hardware_id_(std::move(hardware_id)) {}

  void frame(const FrameReport& report);
  void result(const FrameResult& result);
  /// `seconds`: since the report before; its rates and latencies are of that time, its counts since the
  /// start.
  DiagnosticReport report(const HealthInput& now, double seconds, CaptureTime at);

 private:
  DiagnosticStatus source_part(const HealthInput& now, double seconds) const;
  DiagnosticStatus pipeline_part(const HealthInput& now, double seconds) const;
  DiagnosticStatus latency_part(const HealthInput& now) const;
  DiagnosticStatus search_part() const;
  DiagnosticStatus dds_part(const HealthInput& now) const;

  std::string hardware_id_;
  std::array<LatencyWindow, 9> stages_;  // as FrameTimes, then the age
  std::string last_failure_;
  std::vector<ObjectOutcome> outcomes_;  // of the newest result
  std::uint64_t nodes_ = 0;
  HealthInput before_;
};

}  // namespace sextant
