// SPDX-License-Identifier: Apache-2.0
// sextant doctor: can this machine do the job? Every finding says what to do.
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "offline/cli/commands.h"
#include "offline/cli/machine_checks.h"
#include "runtime/base/error.h"

namespace sextant {
namespace {

struct Arguments {
  std::vector<std::filesystem::path> models;
  unsigned domain = 0;
  bool no_dds = false;
  bool json = false;
};

int run(const Arguments& a) {
  const MachinePlaces here;
  std::vector<Finding> all;
  const auto add = [&](const std::vector<Finding>& some) {
    all.insert(all.end(), some.begin(), some.end());
    if (!a.json) print_findings(some);
  };
  add(check_processor(here));
  add(check_memory(here));
  add(check_disk(std::filesystem::current_path()));
  add(check_camera_permissions(here));
  add(check_clock());
  add(check_socket_buffers(here));
  if (!a.no_dds) add(check_dds(a.domain));
  add(check_rendering());
  add(check_models(a.models));
  if (a.json) fmt::print("{}\n", nlohmann::ordered_json{{"findings", findings_json(all)}}.dump());
  return static_cast<int>(any_bad(all) ? ExitCode::kDeviceOrNetwork : ExitCode::kDone);
}

}  // namespace

CLI::App* add_doctor_command(CLI::App& app, int& exit_code) {
  auto a = std::make_shared<Arguments>();
  CLI::App* command =
      app.add_subcommand("doctor", "check this machine: processor, cameras, network, rendering, models");
  command->footer("Example: sextant doctor models/*.sxm\nExit code 4 where something is bad.");
  command->add_option("models", a->models, "compiled models to check too");
  command->add_option("--domain", a->domain, "DDS domain")->check(CLI::Range(0, 230))->capture_default_str();
  command->add_flag("--no-dds", a->no_dds, "leave the DDS check out");
  command->add_flag("--json", a->json, "one JSON object");
  command->callback([a, &exit_code] { exit_code = run(*a); });
  return command;
}

}  // namespace sextant
