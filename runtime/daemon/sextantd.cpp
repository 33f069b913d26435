// SPDX-License-Identifier: Apache-2.0
// sextantd: frames in from the hardware layer, poses out over DDS.
#include <fmt/format.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <memory>
#include <vector>

#include "hal/playback/bop_source.h"
#include "runtime/base/error.h"
#include "runtime/base/rate_limiter.h"
#include "runtime/base/version.h"
#include "runtime/daemon/config_reader.h"
#include "runtime/daemon/config_reference.h"
#include "runtime/daemon/daemon.h"
#include "runtime/daemon/object_shapes.h"
#include "runtime/detect/detector.h"
#include "runtime/model/model_file.h"
#include "runtime/publish/dds_log.h"

namespace sextant {
namespace {

/// What the command line asks for.
struct Arguments {
  std::string config;
  bool check_config = false;
  bool once = false;
  bool reference = false;
};

std::vector<ObjectModel> load_models(const DaemonConfig& config) {
  std::vector<ObjectModel> models;
  for (const std::filesystem::path& file : model_files(config)) {
    models.push_back(read_model(file));
    spdlog::info("model {}: {} (object {}), {} bins", file.string(), models.back().name,
                 models.back().object_id, models.back().bins.size());
  }
  return models;
}

void run(const DaemonConfig& config, bool once, SignalWaiter& signals) {
  const DdsLog dds_log([](const std::string& line) { spdlog::warn("DDS: {}", line); });
  std::vector<ObjectModel> models = load_models(config);
  PublisherOptions publishing = publisher_options(config);
  publishing.object_shapes = object_shapes(models);
  Detector detector(std::move(models), detect_options(config));
  const std::unique_ptr<FrameSource> source = open_bop_source(source_options(config));
  RateLimiter limiter(5, std::chrono::seconds(10));
  auto publisher = std::make_unique<Publisher>(publishing, [&](const std::string& line) {
    std::uint64_t held_back = 0;
    if (limiter.pass(RateLimiter::Clock::now(), held_back))
      spdlog::warn("{} ({} held back)", line, held_back);
  });
  spdlog::info("publishing on DDS domain {}", publishing.domain);

  DaemonRun options;
  options.pipeline = pipeline_options(config);
  options.pipeline.once = once;
  options.once_wait = std::chrono::milliseconds(static_cast<std::int64_t>(config.publish.once_wait_ms));
  options.abandon = [&] {
    publisher.reset();  // readers learn at once that we are gone
    spdlog::shutdown();
    std::_Exit(static_cast<int>(ExitCode::kDone));
  };
  run_daemon(
      *source, [&](const RgbdFrame& frame) { return detector.detect(frame); }, *publisher, signals, options);
}

int run_program(const Arguments& arguments) {
  if (arguments.config.empty()) {
    if (!arguments.reference)
      throw UsageError("--config is missing", "for example: --config config/sextantd.yaml");
    fmt::print("{}", config_reference({}));
    return 0;
  }
  SignalWaiter signals;
  const DaemonConfig config = read_config(arguments.config);
  if (arguments.reference) {
    fmt::print("{}", config_reference(config));
    return 0;
  }
  if (arguments.check_config) {
    fmt::print("{}: good (models and data set are opened only when it runs)\n", arguments.config);
    return 0;
  }
  spdlog::set_level(spdlog::level::from_str(config.log.level));
  run(config, arguments.once, signals);
  return 0;
}

}  // namespace
}  // namespace sextant

int main(int argc, char** argv) {
  using sextant::ExitCode;
  spdlog::set_default_logger(spdlog::stderr_color_mt("sextantd"));
  spdlog::set_pattern("%Y-%m-%dT%H:%M:%S.%e %^%l%$ %v");
  CLI::App app("sextantd: finds known objects in the frames of a camera and publishes their poses over DDS");
  app.footer("Example: sextantd --config config/sextantd.yaml\nSIGTERM and SIGINT end it within a second.");
  sextant::Arguments arguments;
  app.add_option("--config", arguments.config, "YAML file, every key documented in config/sextantd.yaml");
  app.add_flag("--check-config", arguments.check_config, "check the file and exit");
  app.add_flag("--once", arguments.once, "one frame, then exit");
  app.add_flag("--print-config-reference", arguments.reference,
               "print the configuration with all keys documented");
  app.set_version_flag("--version", "sextantd (" + std::string(sextant::kProgramVersion) + ")");
  try {
    app.parse(argc, argv);
    return sextant::run_program(arguments);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : static_cast<int>(ExitCode::kWrongUse);
  } catch (const sextant::DoorError& error) {
    fmt::print(stderr, "sextantd: {}\n", error.what());
    return static_cast<int>(error.exit_code());
  } catch (const std::exception& error) {
    fmt::print(stderr, "sextantd: our bug: {}\n", error.what());
    return static_cast<int>(ExitCode::kOurBug);
  }
}
