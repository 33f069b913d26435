// SPDX-License-Identifier: Apache-2.0
#include "offline/cli/ask.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "offline/cli/stop_on_signal.h"
#include "runtime/base/error.h"
#include "runtime/publish/command_client.h"
#include "runtime/publish/dds_log.h"

namespace sextant {

namespace {

void print_warning(const std::string& line) { fmt::print(stderr, "sextant ask: {}\n", line); }

std::string new_request_id() {
  std::random_device random;
  return fmt::format("sextant-ask-{}-{:08x}{:08x}", getpid(), random(), random());
}

/// What the command line gives beside the shared options.
struct Question {
  AskOptions options;
  Command command;
  std::string value;  // a number or "auto"
  std::vector<std::uint32_t> region;
};

double number_or_auto(const std::string& text, const char* what) {
  if (text == "auto") return std::numeric_limits<double>::quiet_NaN();
  try {
    std::size_t used = 0;
    const double number = std::stod(text, &used);
    if (used == text.size() && !std::isnan(number)) return number;
  } catch (const std::exception&) {
    // No number: refused below.
  }
  throw UsageError(fmt::format("{} '{}' is no number", what, text),
                   "give a number, or auto for the configured one");
}

}  // namespace

int run_ask(const AskOptions& options, Command command, std::FILE* out) {
  if (!(options.timeout_s > 0 && options.timeout_s <= 1e6))
    throw UsageError("--timeout-s must be above 0, at most 1e6");
  const StopOnSignal signals;
  const DdsLog log(print_warning);
  command.request_id = new_request_id();
  CommandClient client(options.domain, options.topics, print_warning);
  const auto timeout = std::chrono::milliseconds(static_cast<std::int64_t>(1000 * options.timeout_s));
  const auto answer = client.ask(command, timeout, [&] { return signals.requested(); });
  if (!answer) {
    const bool alone = client.matched_daemons() == 0;
    throw DeviceError(
        "DDS",
        fmt::format("no answer within {} s{}", options.timeout_s, alone ? ": no sextantd is there" : ""),
        "is it running on this domain and namespace, with commands switched on?");
  }
  fmt::print(out, "{}\n", options.json ? answer->json : answer->text);
  if (std::fflush(out) != 0)
    throw DeviceError("output", "cannot write", "is the disk full or the pipe closed?");
  if (answer->result == CommandResult::kRefused) return static_cast<int>(ExitCode::kWrongUse);
  if (answer->result != CommandResult::kDone) return static_cast<int>(ExitCode::kBadInput);
  const bool missed = command.kind == CommandKind::kLook && options.require && !answer->found;
  return static_cast<int>(missed ? ExitCode::kNothingFound : ExitCode::kDone);
}

CLI::App* add_ask_command(CLI::App& app, int& exit_code) {
  auto question = std::make_shared<Question>();
  CLI::App* ask = app.add_subcommand("ask", "Ask a running sextantd: look once, load, enable, ...");
  ask->footer(
      "Example: sextant ask look mug --json --require\nExit codes: 1 nothing found with --require, 2 "
      "refused, "
      "3 failed, 4 no answer.");
  ask->require_subcommand(1);

  // On the parent: options with an environment variable are read for subcommands that were not chosen, too.
  AskOptions& o = question->options;
  ask->add_option("--domain", o.domain, "DDS domain, 0..230")
      ->envname("ROS_DOMAIN_ID")
      ->check(CLI::Range(0, 230))
      ->capture_default_str();
  ask->add_option("--namespace", o.topics.name_space, "publish.namespace of the daemon");
  ask->add_option("--command-topic", o.topics.command_topic, "commands.command of the daemon")
      ->capture_default_str();
  ask->add_option("--answer-topic", o.topics.answer_topic, "commands.answer of the daemon")
      ->capture_default_str();
  ask->add_option("--timeout-s", o.timeout_s, "give up after so many seconds")->capture_default_str();
  ask->add_flag("--json", o.json, "one JSON object");

  const auto add = [&](const std::string& name, const std::string& text, CommandKind kind) {
    CLI::App* command = ask->add_subcommand(name, text);
    command->fallthrough();
    command->callback([question, kind, &exit_code] {
      Question& q = *question;
      q.command.kind = kind;
      if (kind == CommandKind::kThreshold) q.command.value = number_or_auto(q.value, "the threshold");
      if (kind == CommandKind::kDeadline) q.command.value = number_or_auto(q.value, "the deadline");
      for (std::size_t i = 0; i < q.region.size(); ++i) q.command.region[i] = q.region[i];
      exit_code = run_ask(q.options, q.command, stdout);
    });
    return command;
  };
  const auto object = [&](CLI::App* command, bool needed) {
    command->add_option("object", question->command.object_name, "name of the object; default: every one")
        ->required(needed);
  };

  add("status", "What is loaded and looked for", CommandKind::kStatus);
  CLI::App* look = add("look", "Look once now, in the next frame, and print the poses", CommandKind::kLook);
  object(look, false);
  look->add_flag("--require", question->options.require, "exit 1 when nothing is found");
  add("load", "Read a compiled model and look for its object", CommandKind::kLoad)
      ->add_option("model", question->command.model_file,
                   "file in a folder of models.files, on the daemon's machine")
      ->required();
  object(add("unload", "Forget a model", CommandKind::kUnload), true);
  object(add("enable", "Look for an object in every frame", CommandKind::kEnable), false);
  object(add("disable", "Look for an object only when asked by look", CommandKind::kDisable), false);
  add("region", "Look only at a part of the image: X Y WIDTH HEIGHT, or 0 0 0 0 for the whole",
      CommandKind::kRegion)
      ->add_option("region", question->region, "pixels of the source image")
      ->expected(4)
      ->required();
  CLI::App* threshold = add("threshold", "Log score that a pose must reach", CommandKind::kThreshold);
  threshold->add_option("value", question->value, "a number, or auto: as configured")->required();
  object(threshold, false);
  add("deadline", "Milliseconds for the search of one frame", CommandKind::kDeadline)
      ->add_option("value", question->value, "milliseconds, 0: none, or auto: as configured")
      ->required();
  add("reload", "Read configuration and models again, as SIGHUP does", CommandKind::kReload);
  return ask;
}

}  // namespace sextant
