// SPDX-License-Identifier: Apache-2.0
#include "offline/cli/echo.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <memory>

#include "offline/cli/stop_on_signal.h"
#include "runtime/base/error.h"
#include "runtime/publish/dds_log.h"
#include "runtime/publish/echo_reader.h"

namespace sextant {

namespace {

using Clock = std::chrono::steady_clock;

/// How long one wait may take: how fast a signal is answered.
constexpr std::chrono::milliseconds kSlice{100};

void print_warning(const std::string& line) { fmt::print(stderr, "sextant echo: {}\n", line); }

}  // namespace

int run_echo(const EchoOptions& options, std::FILE* out) {
  if (options.count < 0) throw UsageError("--count must not be negative");
  if (!(options.timeout_s >= 0 && options.timeout_s <= 1e9)) throw UsageError("--timeout-s must be 0..1e9");
  const TopicKind kind = topic_kind_of(options.type.empty() ? options.topic : options.type);
  const StopOnSignal signals;
  const DdsLog log(print_warning);

  int printed = 0;
  EchoReader reader(
      {options.domain, options.topic, kind},
      [&](const EchoMessage& message) {
        fmt::print(out, "{}\n", options.json ? message.json : message.text);
        if (std::fflush(out) != 0)
          throw DeviceError("output", "cannot write", "is the disk full or the pipe closed?");
        ++printed;
      },
      print_warning);

  const Clock::time_point start = Clock::now();
  const std::chrono::duration<double> limit(options.timeout_s);
  while (!signals.requested() && (options.count == 0 || printed < options.count)) {
    if (options.timeout_s > 0 && Clock::now() - start >= limit) break;
    reader.poll(kSlice, options.count == 0 ? 100 : options.count - printed);
  }
  const bool met = printed >= std::max(1, options.count);
  return static_cast<int>(options.require && !met ? ExitCode::kNothingFound : ExitCode::kDone);
}

CLI::App* add_echo_command(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<EchoOptions>();
  CLI::App* command = app.add_subcommand("echo", "Print poses that arrive over DDS");
  command->footer("Example: sextant echo --topic object_pose --count 1 --timeout-s 10 --require --json");
  command
      ->add_option("--topic", options->topic,
                   "topic without rt/, with its namespace: arm/pose_estimates, tf, diagnostics, ...")
      ->capture_default_str();
  command->add_option("--type", options->type, "what it carries; default: by the last part of the topic")
      ->check(CLI::IsMember(topic_kind_names()));
  command->add_option("--domain", options->domain, "DDS domain, 0..230")
      ->envname("ROS_DOMAIN_ID")
      ->check(CLI::Range(0, 230))
      ->capture_default_str();
  command->add_option("--count", options->count, "end after so many messages; 0: never")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->add_option("--timeout-s", options->timeout_s, "end after so many seconds; 0: never")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->add_flag("--json", options->json, "one JSON object per line");
  command->add_flag("--require", options->require, "exit 1 when nothing (or fewer than --count) arrived");
  command->callback([options, &exit_code] { exit_code = run_echo(*options, stdout); });
  return command;
}

}  // namespace sextant
