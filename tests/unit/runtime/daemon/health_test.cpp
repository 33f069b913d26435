// SPDX-License-Identifier: Apache-2.0
// Diagnostics: rates and latencies are of the time since the last report, levels say what a robot must know.
#include "runtime/daemon/health.h"

#include <gmock/gmock.h>

#include <fstream>

#include "runtime/daemon/temperatures.h"
#include "tests/support/temporary_folder.h"

namespace sextant {
namespace {

std::string value_of(const DiagnosticReport& report, std::size_t part, const std::string& key) {
  for (const auto& [k, v] : report.parts.at(part).values) {
    if (k == key) return v;
  }
  return "missing: " + key;
}

FrameReport published(double age_ms) {
  FrameReport report;
  report.age_ms = age_ms;
  report.times = {1, 2, 3, 4, 5, 6, 7, 8};
  return report;
}

constexpr std::size_t kSource = 0, kPipeline = 1, kLatency = 2, kSearch = 3, kDds = 4, kWarmth = 5;

TEST(LatencyWindow, TellsMedianTailAndWorstOfTheLastValues) {
  LatencyWindow window;
  EXPECT_EQ(window.summary().largest, 0);
  for (int i = 100; i >= 1; --i) window.add(i);
  EXPECT_EQ(window.summary().median, 50);
  EXPECT_EQ(window.summary().p95, 95);
  EXPECT_EQ(window.summary().largest, 100);
  for (std::size_t i = 0; i < LatencyWindow::kCapacity; ++i) window.add(1);
  EXPECT_EQ(window.summary().largest, 1);  // the old ones are gone
  EXPECT_EQ(window.size(), LatencyWindow::kCapacity);
}

TEST(Health, TellsRatesLatenciesAndCounts) {
  Health health("arm");
  HealthInput now;
  now.pipeline.published = 60;
  now.source.delivered = 90;
  now.readers = 2;
  for (int i = 1; i <= 99; ++i) health.frame(published(i));
  FrameResult result;
  result.objects.push_back({0, 1, "mug", SearchStatus::kOptimal, 0, 0, 0.5});
  result.nodes = 77;
  health.result(result);
  DiagnosticReport report = health.report(now, 2, CaptureTime(std::chrono::seconds(5)));
  EXPECT_EQ(report.hardware_id, "arm");
  EXPECT_EQ(report.at, CaptureTime(std::chrono::seconds(5)));
  for (const DiagnosticStatus& part : report.parts) EXPECT_EQ(part.level, DiagnosticLevel::kOk) << part.name;
  EXPECT_EQ(value_of(report, kSource, "rate_hz"), "45.000");
  EXPECT_EQ(value_of(report, kPipeline, "rate_hz"), "30.000");
  EXPECT_EQ(value_of(report, kLatency, "age_ms_median"), "50.000");
  EXPECT_EQ(value_of(report, kLatency, "age_ms_max"), "99.000");
  EXPECT_EQ(value_of(report, kLatency, "search_ms_p95"), "5.000");
  EXPECT_EQ(value_of(report, kLatency, "publish_ms_median"), "8.000");
  EXPECT_EQ(value_of(report, kSearch, "mug"), "optimal");
  EXPECT_EQ(value_of(report, kSearch, "nodes"), "77");
  EXPECT_EQ(value_of(report, kDds, "readers"), "2");

  now.pipeline.published = 63;
  report = health.report(now, 1, {});
  EXPECT_EQ(value_of(report, kPipeline, "rate_hz"), "3.000");
  EXPECT_EQ(value_of(report, kLatency, "age_ms_max"), "0.000");  // of the time since the last report
}

TEST(Health, LevelsSayWhatIsWrong) {
  const auto report_of = [](const std::function<void(HealthInput&, Health&)>& change) {
    Health health("x");
    HealthInput now;
    now.pipeline.published = 1;
    change(now, health);
    return health.report(now, 1, {});
  };
  EXPECT_EQ(report_of([](auto& now, auto&) { now.pipeline.published = 0; }).parts[kPipeline].level,
            DiagnosticLevel::kStale);
  EXPECT_EQ(report_of([](auto& now, auto&) { now.pipeline.too_old = 2; }).parts[kPipeline].level,
            DiagnosticLevel::kWarn);
  const DiagnosticReport failing = report_of([](auto& now, auto& health) {
    now.pipeline.published = 0;
    now.pipeline.failed = 3;
    FrameReport story;
    story.fate = FrameFate::kFailed;
    story.reason = "no table";
    health.frame(story);
  });
  EXPECT_EQ(failing.parts[kPipeline].level, DiagnosticLevel::kError);
  EXPECT_EQ(value_of(failing, kPipeline, "last_failure"), "no table");
  const DiagnosticReport away = report_of([](auto& now, auto&) {
    now.source_state = SourceState::kWaiting;
    now.source_condition = "unplugged";
  });
  EXPECT_EQ(away.parts[kSource].level, DiagnosticLevel::kError);
  EXPECT_EQ(away.parts[kSource].message, "waiting: unplugged");
  EXPECT_EQ(report_of([](auto& now, auto&) { now.source_state = SourceState::kEnded; }).parts[kSource].level,
            DiagnosticLevel::kStale);
  EXPECT_EQ(report_of([](auto& now, auto&) { now.source.drop(DropReason::kLost) = 1; }).parts[kSource].level,
            DiagnosticLevel::kWarn);
  EXPECT_EQ(report_of([](auto& now, auto&) { now.publisher.timeouts = 1; }).parts[kDds].level,
            DiagnosticLevel::kWarn);
  EXPECT_EQ(report_of([](auto& now, auto&) { now.publisher.too_old = 1; }).parts[kDds].level,
            DiagnosticLevel::kWarn);
  const DiagnosticReport bounded = report_of([](auto&, auto& health) {
    FrameResult result;
    result.objects.push_back({0, 1, "mug", SearchStatus::kBounded, 0, 0, 1});
    health.result(result);
  });
  EXPECT_EQ(bounded.parts[kSearch].level, DiagnosticLevel::kWarn);
  const DiagnosticReport hot = report_of([](auto& now, auto&) { now.temperatures_celsius = {{"cpu", 96}}; });
  EXPECT_EQ(hot.parts.at(kWarmth).level, DiagnosticLevel::kWarn);
  EXPECT_EQ(value_of(hot, kWarmth, "cpu"), "96.000");
}

TEST(Temperatures, AreThoseThatTheKernelTells) {
  const TemporaryFolder folder;
  EXPECT_TRUE(read_temperatures(folder.path()).empty());
  const auto zone = [&](int i, const std::string& type, const std::string& temp) {
    const auto path = folder / ("thermal_zone" + std::to_string(i));
    std::filesystem::create_directories(path);
    std::ofstream(path / "type") << type << "\n";
    std::ofstream(path / "temp") << temp << "\n";
  };
  zone(0, "x86_pkg_temp", "45500");
  zone(1, "off", "-274000");
  zone(2, "broken", "warm");
  zone(5, "soc", "61000");
  EXPECT_THAT(read_temperatures(folder.path()),
              testing::ElementsAre(testing::Pair("x86_pkg_temp (0)", 45.5), testing::Pair("soc (5)", 61.0)));
}

}  // namespace
}  // namespace sextant
