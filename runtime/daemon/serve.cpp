// SPDX-License-Identifier: Apache-2.0
#include "runtime/daemon/serve.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <cstdlib>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "hal/sources/open_source.h"
#include "hal/table/table_locator.h"
#include "runtime/base/error.h"
#include "runtime/base/rate_limiter.h"
#include "runtime/daemon/annotate.h"
#include "runtime/daemon/command_loop.h"
#include "runtime/daemon/config_reader.h"
#include "runtime/daemon/config_reference.h"
#include "runtime/daemon/config_reload.h"
#include "runtime/daemon/last_resort.h"
#include "runtime/daemon/object_shapes.h"
#include "runtime/daemon/service_notifier.h"
#include "runtime/publish/dds_log.h"
#include "runtime/publish/dds_settings.h"
#include "runtime/publish/message_check.h"

namespace sextant {
namespace {

/// From the signal to leaving, within a second.
constexpr std::chrono::milliseconds kPatienceAtTheEnd{900};

/// Without waiting for threads that still run; nothing that they use is taken away from them.
[[noreturn]] void leave_process() {
  spdlog::default_logger_raw()->flush();
  std::_Exit(static_cast<int>(ExitCode::kDone));
}

DetectionSetup detection_setup(const DaemonConfig& config) {
  DetectionSetup setup;
  setup.models = load_models(model_files(config));
  for (const LoadedModel& loaded : setup.models) {
    spdlog::info("model {}: {} (object {}), {} bins", loaded.file.string(), loaded.model.name,
                 loaded.model.object_id, loaded.model.bins.size());
  }
  setup.options = detect_options(config);
  setup.model_folders = model_folders(config);
  setup.max_look_age_ms = config.pipeline.max_age_ms;
  return setup;
}

/// Lines that others can cause as often as they like, at a limited rate. From any thread.
class LimitedLog {
 public:
  void operator()(spdlog::level::level_enum level, const std::string& line) {
    const std::lock_guard lock(mutex_);
    std::uint64_t held_back = 0;
    if (!limiter_.pass(RateLimiter::Clock::now(), held_back)) return;
    spdlog::log(level, "{}{}", line,
                held_back > 0 ? fmt::format(" ({} such lines held back)", held_back) : "");
  }

 private:
  std::mutex mutex_;
  RateLimiter limiter_{5, std::chrono::seconds(10)};
};

/// What was asked and what became of it, for the log.
std::string in_words(const Command& command, const CommandAnswer& answer) {
  // The message may repeat what a stranger wrote.
  return fmt::format("command {} ({}): {}", to_string(command.kind), command.request_id,
                     printable(answer.message.c_str()));
}

ObjectShapes shapes_of(const DetectionSetup& setup) {
  ObjectShapes shapes;
  for (const LoadedModel& loaded : setup.models) shapes.merge(object_shapes({loaded.model}));
  return shapes;
}

/// Opens something that needs the network or a device. Without `once` it waits for it, says so once, and
/// tries every second; nothing when a signal came first.
template <typename Open>
auto open_patiently(const Open& open, bool once, SignalWaiter& signals) -> decltype(open()) {
  const ServiceNotifier notifier;
  for (bool said = false;; said = true) {
    try {
      auto opened = open();
      if (said) spdlog::info("it works now");
      return opened;
    } catch (const DeviceError& error) {
      if (once) throw;
      if (!said) {
        spdlog::warn("waiting: {}", error.what());
        notifier.ready();
        notifier.status(std::string("waiting: ") + error.what());
      }
    }
    notifier.alive();
    const auto signal = signals.wait(std::chrono::seconds(1));
    if (signal && *signal != SIGHUP) return nullptr;
  }
}

/// The running daemon's configuration, replaced whole or not at all.
class RunningConfig {
 public:
  RunningConfig(std::string file, DaemonConfig config) : file_(std::move(file)), config_(std::move(config)) {}

  std::string reload(DetectionService& service) {
    const std::lock_guard lock(mutex_);
    DaemonConfig changed = read_config(file_);
    const std::vector<std::string> keys = check_reload(config_, changed, file_);
    service.replace(detection_setup(changed));
    spdlog::set_level(spdlog::level::from_str(changed.log.level));
    config_ = std::move(changed);
    return keys.empty() ? "models read again, no key has changed"
                        : fmt::format("models read again, changed: {}", fmt::join(keys, ", "));
  }

 private:
  std::mutex mutex_;
  std::string file_;
  DaemonConfig config_;
};

void run(const std::string& file, const DaemonConfig& config, bool once, SignalWaiter& signals,
         const SearchElsewhere& search_elsewhere) {
  use_dds_defaults();
  // The first to be made and the last to go: everything below has to end in time.
  std::optional<LastResort> last_resort;
  const DdsLog dds_log([](const std::string& line) { spdlog::warn("DDS: {}", line); });
  DetectionSetup setup = detection_setup(config);
  PublisherOptions publishing = publisher_options(config);
  publishing.object_shapes = shapes_of(setup);
  std::mutex shapes_mutex;  // guards `shapes`
  ObjectShapes shapes = publishing.object_shapes;
  std::unique_ptr<Publisher> publisher;
  DetectionService service(
      std::move(setup),
      [&](const std::vector<ObjectModel>& models) {
        const std::lock_guard lock(shapes_mutex);
        shapes = object_shapes(models);
        publisher->set_object_shapes(shapes);
      },
      search_elsewhere);

  LimitedLog network_log, command_log;
  const WarnFunction warn = [&](const std::string& line) { network_log(spdlog::level::warn, line); };
  publisher = open_patiently([&] { return std::make_unique<Publisher>(publishing, warn); }, once, signals);
  if (!publisher) return;
  spdlog::info("publishing on DDS domain {}", publishing.domain);
  const std::unique_ptr<FrameSource> source =
      open_patiently([&] { return open_source(source_options(config)); }, once, signals);
  if (!source) return;

  RunningConfig running(file, config);
  const auto reload = [&] { return running.reload(service); };
  std::unique_ptr<CommandServer> commands;
  std::unique_ptr<CommandLoop> command_loop;
  if (!once && !config.commands.command.empty()) {
    commands = std::make_unique<CommandServer>(publisher->participant(), command_options(config), warn);
    CommandLoopOptions options;
    options.reload = reload;
    options.look_patience =
        std::chrono::milliseconds(static_cast<std::int64_t>(config.commands.look_patience_ms));
    options.answered = [&](const Command& command, const CommandAnswer& answer) {
      command_log(answer.result == CommandResult::kDone ? spdlog::level::info : spdlog::level::warn,
                  in_words(command, answer));
    };
    options.failed = [](const std::string& why) { spdlog::error("commands are off: {}", why); };
    command_loop = std::make_unique<CommandLoop>(*commands, service, std::move(options));
  }

  DaemonRun options;
  options.pipeline = pipeline_options(config);
  options.pipeline.once = once;
  options.once_wait = std::chrono::milliseconds(static_cast<std::int64_t>(config.publish.once_wait_ms));
  options.diagnostics_period =
      std::chrono::milliseconds(static_cast<std::int64_t>(config.publish.diagnostics_period_ms));
  if (!config.publish.name_space.empty()) options.hardware_id = config.publish.name_space;
  options.reload = reload;
  options.ending = [&] {
    last_resort.emplace(kPatienceAtTheEnd, [] {
      spdlog::warn("something does not end in time and is left behind");
      leave_process();
    });
  };
  options.cancel = [&] { service.cancel(); };
  options.draw = [&](const RgbdFrame& frame, const FrameResult& result) {
    const std::lock_guard lock(shapes_mutex);
    return annotate(frame, result, shapes);
  };
  options.abandon = [&] {
    publisher->leave();  // readers learn at once that we are gone
    leave_process();
  };
  std::optional<TableLocator> locator;
  if (const auto table = table_options(config)) locator.emplace(*table);
  const auto detect = [&](const RgbdFrame& frame) {
    if (!locator) return service.detect(frame);
    RgbdFrame located = frame;  // shares the pixels
    locator->locate(located);
    return service.detect(located);
  };
  run_daemon(*source, detect, *publisher, signals, options);
}

}  // namespace

void ServeArguments::add_to(CLI::App& app) {
  app.footer("SIGTERM and SIGINT end it within a second, SIGHUP reads models and configuration again.");
  app.add_option("--config", config, "YAML file, every key documented in config/sextantd.yaml");
  app.add_flag("--check-config", check_config, "check the file and exit");
  app.add_flag("--once", once, "one frame, then exit");
  app.add_flag("--print-config-reference", reference, "print the configuration with all keys documented");
}

void serve(const ServeArguments& arguments, SignalWaiter& signals, const SearchElsewhere& search_elsewhere) {
  if (arguments.config.empty()) {
    if (!arguments.reference)
      throw UsageError("--config is missing", "for example: --config config/sextantd.yaml");
    fmt::print("{}", config_reference({}));
    return;
  }
  const DaemonConfig config = read_config(arguments.config);
  if (arguments.reference) {
    fmt::print("{}", config_reference(config));
    return;
  }
  if (arguments.check_config) {
    fmt::print("{}: good (models and data set are opened only when it runs)\n", arguments.config);
    return;
  }
  spdlog::set_level(spdlog::level::from_str(config.log.level));
  run(arguments.config, config, arguments.once, signals, search_elsewhere);
}

}  // namespace sextant
