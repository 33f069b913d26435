// SPDX-License-Identifier: Apache-2.0
#include "runtime/daemon/health.h"

#include <fmt/format.h>

#include <algorithm>

namespace sextant {

namespace {

constexpr std::array kStages = {"capture", "waiting",  "features", "tables", "search",
                                "refine",  "handover", "publish",  "age"};
constexpr double kHotCelsius = 95;

template <typename Number>
std::pair<std::string, std::string> value(const std::string& key, Number number) {
  if constexpr (std::is_floating_point_v<Number>) {
    return {key, fmt::format("{:.3f}", number)};
  } else {
    return {key, fmt::format("{}", number)};
  }
}

double rate(std::uint64_t now, std::uint64_t before, double seconds) {
  return seconds > 0 ? static_cast<double>(now - before) / seconds : 0;
}

}  // namespace

void Health::frame(const FrameReport& report) {
  if (report.fate != FrameFate::kPublished) {
    last_failure_ = report.reason;
    return;
  }
  const FrameTimes& t = report.times;
  const std::array values = {t.capture_ms, t.waiting_ms,  t.features_ms, t.tables_ms,  t.search_ms,
                             t.refine_ms,  t.handover_ms, t.publish_ms,  report.age_ms};
  for (std::size_t i = 0; i < values.size(); ++i) stages_[i].add(values[i]);
}

void Health::result(const FrameResult& result) {
  outcomes_ = result.objects;
  nodes_ = result.nodes;
}

DiagnosticStatus Health::source_part(const HealthInput& now, double seconds) const {
  DiagnosticStatus part;
  part.name = "sextantd: source";
  switch (now.source_state) {
    case SourceState::kRunning:
      part.message = now.source_condition.empty() ? "running" : now.source_condition;
      break;
    case SourceState::kWaiting:
      part.level = DiagnosticLevel::kError;
      part.message = "waiting: " + now.source_condition;
      break;
    case SourceState::kEnded:
      part.level = DiagnosticLevel::kStale;
      part.message = "no more frames will come";
      break;
  }
  part.values = {value("delivered", now.source.delivered),
                 value("rate_hz", rate(now.source.delivered, before_.source.delivered, seconds)),
                 value("reconnects", now.source.reconnects),
                 {"dropped", describe_drops(now.source)}};
  if (part.level == DiagnosticLevel::kOk && now.source.dropped() > before_.source.dropped()) {
    part.level = DiagnosticLevel::kWarn;
    part.message = fmt::format("{} frames dropped since the last report",
                               now.source.dropped() - before_.source.dropped());
  }
  return part;
}

DiagnosticStatus Health::pipeline_part(const HealthInput& now, double seconds) const {
  DiagnosticStatus part;
  part.name = "sextantd: pipeline";
  const PipelineStatistics &p = now.pipeline, &b = before_.pipeline;
  part.values = {value("published", p.published),
                 value("rate_hz", rate(p.published, b.published, seconds)),
                 value("dropped_waiting", p.dropped),
                 value("dropped_unpublished", p.unpublished),
                 value("stale", p.stale),
                 value("too_old", p.too_old),
                 value("failed", p.failed),
                 {"last_failure", last_failure_.substr(0, 1000)}};
  const std::uint64_t published = p.published - b.published;
  const std::uint64_t late = p.too_old - b.too_old + (p.stale - b.stale);
  const std::uint64_t failed = p.failed - b.failed;
  const std::uint64_t dropped = p.dropped - b.dropped + (p.unpublished - b.unpublished);
  part.message = fmt::format("{} published, {} dropped for newer ones, {} too late, {} failed", published,
                             dropped, late, failed);
  if (late + failed > 0) part.level = DiagnosticLevel::kWarn;
  if (published == 0) part.level = late + failed > 0 ? DiagnosticLevel::kError : DiagnosticLevel::kStale;
  return part;
}

DiagnosticStatus Health::latency_part(const HealthInput& now) const {
  DiagnosticStatus part;
  part.name = "sextantd: latency";
  for (std::size_t i = 0; i < stages_.size(); ++i) {
    const LatencySummary s = stages_[i].summary();
    part.values.push_back(value(fmt::format("{}_ms_median", kStages[i]), s.median));
    part.values.push_back(value(fmt::format("{}_ms_p95", kStages[i]), s.p95));
    part.values.push_back(value(fmt::format("{}_ms_max", kStages[i]), s.largest));
  }
  part.values.push_back(value("max_age_ms", now.max_age_ms));
  const LatencySummary age = stages_.back().summary();
  part.message =
      stages_.back().size() == 0
          ? "no frame since the last report"
          : fmt::format("capture to publication: median {:.1f} ms, 95 % {:.1f} ms", age.median, age.p95);
  return part;
}

DiagnosticStatus Health::search_part() const {
  DiagnosticStatus part;
  part.name = "sextantd: search";
  std::size_t bounded = 0;
  for (const ObjectOutcome& object : outcomes_) {
    part.values.emplace_back(object.object_name, to_string(object.status));
    part.values.push_back(value(object.object_name + "_coverage", object.coverage));
    bounded += object.status == SearchStatus::kBounded ? 1 : 0;
  }
  part.values.push_back(value("nodes", nodes_));
  part.message =
      outcomes_.empty() ? "nothing is looked for"
      : bounded > 0
          ? fmt::format("{} of {} objects without proof (deadline)", bounded, outcomes_.size())
          : fmt::format("{} object{}, each proven", outcomes_.size(), outcomes_.size() == 1 ? "" : "s");
  if (bounded > 0) part.level = DiagnosticLevel::kWarn;
  return part;
}

DiagnosticStatus Health::dds_part(const HealthInput& now) const {
  DiagnosticStatus part;
  part.name = "sextantd: DDS";
  const PublisherStatistics &p = now.publisher, &b = before_.publisher;
  part.values = {value("readers", now.readers), value("writes_timed_out", p.timeouts),
                 value("messages_too_old", p.too_old)};
  const std::uint64_t lost = p.timeouts - b.timeouts + (p.too_old - b.too_old);
  part.message = lost > 0 ? fmt::format("{} messages lost: a reliable reader does not keep up", lost)
                          : fmt::format("{} reader{}", now.readers, now.readers == 1 ? "" : "s");
  if (lost > 0) part.level = DiagnosticLevel::kWarn;
  return part;
}

DiagnosticReport Health::report(const HealthInput& now, double seconds, CaptureTime at) {
  DiagnosticReport report;
  report.at = at;
  report.hardware_id = hardware_id_;
  report.parts = {source_part(now, seconds), pipeline_part(now, seconds), latency_part(now), search_part(),
                  dds_part(now)};
  if (!now.temperatures_celsius.empty()) {
    DiagnosticStatus part;
    part.name = "sextantd: temperature";
    double warmest = now.temperatures_celsius.front().second;
    for (const auto& [zone, celsius] : now.temperatures_celsius) {
      part.values.push_back(value(zone, celsius));
      warmest = std::max(warmest, celsius);
    }
    part.message = fmt::format("warmest {:.1f} C", warmest);
    if (warmest >= kHotCelsius) part.level = DiagnosticLevel::kWarn;
    report.parts.push_back(std::move(part));
  }
  for (LatencyWindow& stage : stages_) stage.clear();
  last_failure_.clear();
  before_ = now;
  return report;
}

}  // namespace sextant
