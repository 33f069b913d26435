// SPDX-License-Identifier: Apache-2.0
// sextantd: frames in from the hardware layer, poses out over DDS.
#include <fmt/format.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>

#include "runtime/base/error.h"
#include "runtime/base/version.h"
#include "runtime/daemon/serve.h"

int main(int argc, char** argv) {
  using sextant::ExitCode;
  spdlog::set_default_logger(spdlog::stderr_color_mt("sextantd"));
  spdlog::set_pattern("%Y-%m-%dT%H:%M:%S.%e %^%l%$ %v");
  CLI::App app("sextantd: finds known objects in the frames of a camera and publishes their poses over DDS");
  sextant::ServeArguments arguments;
  arguments.add_to(app);
  app.footer("Example: sextantd --config config/sextantd.yaml\n" + app.get_footer());
  app.set_version_flag("--version", "sextantd (" + std::string(sextant::kProgramVersion) + ")");
  try {
    app.parse(argc, argv);
    sextant::SignalWaiter signals;
    sextant::serve(arguments, signals);
    return 0;
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
