// SPDX-License-Identifier: Apache-2.0
// sextant camera list | check | show: which cameras there are, what one really does, and a picture of it.
#include <fmt/format.h>

#include <chrono>
#include <nlohmann/json.hpp>

#include "hal/dds/image_topics.h"
#include "hal/image/image_file.h"
#include "hal/libcamera/libcamera_source.h"
#include "hal/v4l2/v4l2_devices.h"
#include "hal/v4l2/v4l2_modes.h"
#include "offline/cli/camera_measurement.h"
#include "offline/cli/commands.h"
#include "offline/cli/progress_bar.h"
#include "offline/cli/source_arguments.h"
#include "offline/cli/stop_on_signal.h"
#include "offline/report/table_picture.h"
#include "runtime/base/error.h"

namespace sextant {
namespace {

using Clock = std::chrono::steady_clock;

struct ListArguments {
  unsigned domain = 0;
  double listen_s = 1.5;
  bool no_dds = false;
  bool json = false;
};

nlohmann::ordered_json json_of(const CameraDevice& d) {
  nlohmann::ordered_json modes = nlohmann::ordered_json::array();
  for (const CameraMode& m : d.modes) {
    modes.push_back({{"format", m.fourcc},
                     {"usable", m.format.has_value()},
                     {"width", m.width},
                     {"height", m.height},
                     {"max_rate_hz", m.max_rate_hz}});
  }
  nlohmann::ordered_json controls = nlohmann::ordered_json::array();
  for (const CameraControl& c : d.controls) {
    nlohmann::ordered_json one = {{"name", c.name},
                                  {"lowest", c.lowest},
                                  {"highest", c.highest},
                                  {"step", c.step},
                                  {"default", c.standard}};
    if (c.value) one["value"] = *c.value;
    controls.push_back(one);
  }
  return {{"kind", d.kind},       {"id", d.id},         {"aliases", d.aliases}, {"node", d.node},
          {"name", d.name},       {"driver", d.driver}, {"bus", d.bus},         {"serial", d.serial},
          {"problem", d.problem}, {"modes", modes},     {"controls", controls}};
}

void print_device(const CameraDevice& d) {
  fmt::print("{} {}\n  {}  {}  driver {}\n", d.kind, d.id, d.node, d.name, d.driver);
  for (const std::string& alias : d.aliases) fmt::print("  also {}\n", alias);
  if (!d.problem.empty()) fmt::print("  cannot be used: {}\n", d.problem);
  if (!d.modes.empty()) fmt::print("  offers {}\n", modes_text(d.modes));
  for (const CameraControl& c : d.controls) {
    fmt::print("  control {} {}..{} default {}{}\n", c.name, c.lowest, c.highest, c.standard,
               c.value ? fmt::format(", now {}", *c.value) : "");
  }
}

int run_list(const ListArguments& a) {
  std::vector<CameraDevice> devices = list_v4l2_devices(true);
  try {
    const std::vector<CameraDevice> more = list_libcamera_devices(true);
    devices.insert(devices.end(), more.begin(), more.end());
  } catch (const std::exception& error) {  // its manager does not start: the others are still there
    fmt::print(stderr, "sextant camera: libcamera: {}\n", error.what());
  }
  std::vector<std::string> topics;
  std::string dds_problem;
  if (!a.no_dds) {
    try {
      topics = list_image_topics(a.domain, std::chrono::milliseconds(static_cast<int>(1000 * a.listen_s)));
    } catch (const DeviceError& error) {
      dds_problem = error.what();
    }
  }
  if (a.json) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const CameraDevice& d : devices) list.push_back(json_of(d));
    fmt::print(
        "{}\n",
        nlohmann::ordered_json{{"devices", list}, {"dds_image_topics", topics}, {"dds_problem", dds_problem}}
            .dump());
    return 0;
  }
  for (const CameraDevice& d : devices) print_device(d);
  if (devices.empty()) {
    fmt::print(
        "no camera device (V4L2): nothing is plugged in, or its driver is not loaded (dmesg says more)\n");
  }
  if (!dds_problem.empty()) fmt::print("DDS: {}\n", dds_problem);
  for (const std::string& topic : topics) fmt::print("dds {}\n", topic);
  if (!a.no_dds && dds_problem.empty() && topics.empty()) {
    fmt::print("no image topic on DDS domain {} within {:.1f} s\n", a.domain, a.listen_s);
  }
  return 0;
}

struct LookArguments {
  SourceArguments source;
  double seconds = 5;
  int frames = 0;
  std::filesystem::path picture;
  bool json = false;
};

/// Measures until enough frames or time.
CameraMeasurement look(const LookArguments& a, SourceStatistics& statistics) {
  const bool live = a.source.source.kind != "playback";
  SourceOptions options = a.source.options();
  const std::unique_ptr<FrameSource> source = open_source(options);
  CameraMeasurement measurement(live || options.playback.rate_hz > 0 ||
                                options.playback.pace == PlaybackPace::kTimestamps);
  const StopOnSignal stop;
  const auto end = Clock::now() + std::chrono::milliseconds(static_cast<std::int64_t>(1000 * a.seconds));
  const auto patience = Clock::now() + std::chrono::seconds(20);
  std::string condition;
  // A data set is looked at whole.
  const auto more = [&] {
    if (stop.requested() || (a.frames > 0 && measurement.frames() >= a.frames)) return false;
    if (source->state() == SourceState::kEnded) return false;
    if (!live && a.frames == 0 && options.playback.rate_hz == 0 && !options.playback.loop) return true;
    return measurement.frames() > 0 ? a.frames > 0 || Clock::now() < end : Clock::now() < patience;
  };
  while (more()) {
    try {
      if (const auto frame = source->next(std::chrono::milliseconds(100))) {
        measurement.add(*frame, read_clocks().monotonic);
      }
    } catch (const InputError& error) {
      fmt::print(stderr, "sextant camera: {}\n", error.what());
    }
    if (source->condition() != condition) {
      condition = source->condition();
      if (!condition.empty()) fmt::print(stderr, "sextant camera: {}\n", condition);
    }
  }
  statistics = source->statistics();
  if (measurement.frames() == 0) {
    throw DeviceError(a.source.describe(),
                      "no frame came" + (condition.empty() ? "" : " (" + condition + ")"),
                      "see sextant camera list and sextant doctor");
  }
  return measurement;
}

void write_picture(const std::filesystem::path& file, const CameraMeasurement& m) {
  std::vector<std::string> lines;
  constexpr double kDegrees = 57.29577951308232;
  if (const auto& e = m.last_estimate()) {
    lines.push_back(
        fmt::format("height {:.3f} m (+-{:.1f} mm)   pitch {:.1f} deg   roll {:.1f} deg (+-{:.2f})",
                    e->table.camera_height_m, 1e3 * e->uncertainty.height_m, e->table.pitch_rad() * kDegrees,
                    e->table.roll_rad() * kDegrees, e->uncertainty.tilt_rad * kDegrees));
    lines.push_back(
        fmt::format("{:.0f} % of the depth lies on the table, {:.1f} mm off it; grid: 10 cm, on the table",
                    100 * e->inlier_share, 1e3 * e->residual_m));
  } else {
    lines.emplace_back("no table was found");
  }
  write_png(file, draw_table_picture(m.last(), lines));
}

int run_check(const LookArguments& a) {
  SourceStatistics statistics;
  const CameraMeasurement m = look(a, statistics);
  if (!a.picture.empty()) write_picture(a.picture, m);
  const std::vector<Finding> findings = m.findings(statistics);
  if (a.json) {
    fmt::print("{}\n", m.json(statistics).dump());
  } else {
    fmt::print("{}: {} frames of {} x {}\n", a.source.describe(), m.frames(), m.last().colour.cols,
               m.last().colour.rows);
    print_findings(findings);
  }
  return static_cast<int>(any_bad(findings) ? ExitCode::kDeviceOrNetwork : ExitCode::kDone);
}

int run_show(const LookArguments& a) {
  LookArguments one = a;
  if (one.frames == 0) one.frames = one.source.source.kind == "playback" ? 1 : 5;
  SourceStatistics statistics;
  const CameraMeasurement m = look(one, statistics);
  write_picture(a.picture, m);
  if (a.json) {
    fmt::print("{}\n", m.json(statistics).dump());
  } else {
    fmt::print("picture of {} written to {}\n", a.source.describe(), a.picture.string());
  }
  return 0;
}

}  // namespace

CLI::App* add_camera_command(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("camera", "list cameras, measure one, show what it sees");
  command->require_subcommand(1);

  auto list = std::make_shared<ListArguments>();
  CLI::App* list_command = command->add_subcommand("list", "cameras of this machine and image topics on DDS");
  list_command->footer("Example: sextant camera list --json");
  list_command->add_option("--domain", list->domain, "DDS domain")
      ->check(CLI::Range(0, 230))
      ->capture_default_str();
  list_command->add_option("--listen-s", list->listen_s, "how long to listen for DDS topics")
      ->check(CLI::Range(0.0, 60.0))
      ->capture_default_str();
  list_command->add_flag("--no-dds", list->no_dds, "devices only");
  list_command->add_flag("--json", list->json, "one JSON object");
  list_command->callback([list, &exit_code] { exit_code = run_list(*list); });

  auto check = std::make_shared<LookArguments>();
  CLI::App* check_command =
      command->add_subcommand("check", "rate, jitter, losses, depth noise and holes, the table; with advice");
  check_command->footer(
      "Examples:\n  sextant camera check --source v4l2 --color-device by-id-of-colour --depth-device "
      "by-id-of-depth --rig rig.yaml\n  sextant camera check --dataset data/sample");
  check->source.add_to(*check_command);
  check_command->add_option("--seconds", check->seconds, "of measuring")
      ->check(CLI::Range(0.1, 3600.0))
      ->capture_default_str();
  check_command->add_option("--frames", check->frames, "instead of a time")->check(CLI::Range(1, 1000000));
  check_command->add_option("--picture", check->picture, "PNG of the last frame with the table's grid");
  check_command->add_flag("--json", check->json, "one JSON object");
  check_command->callback([check, &exit_code] { exit_code = run_check(*check); });

  auto show = std::make_shared<LookArguments>();
  CLI::App* show_command =
      command->add_subcommand("show", "a picture: colour with the table's grid, depth, holes");
  show_command->footer("Example: sextant camera show --dataset data/sample -o camera.png");
  show->source.add_to(*show_command);
  show_command->add_option("-o,--output", show->picture, "PNG to write")->required();
  show_command->add_option("--frames", show->frames, "look at so many first")->check(CLI::Range(1, 1000000));
  show_command->add_flag("--json", show->json, "also what was measured, as one JSON object");
  show_command->callback([show, &exit_code] { exit_code = run_show(*show); });
  return command;
}

}  // namespace sextant
