// SPDX-License-Identifier: Apache-2.0
// sextant: the offline toolchain. Exit codes: 0 done, 1 nothing found where required, 2 wrong use, 3 bad
// input, 4 a device or the network failed, 5 a proof's claim is false, 70 our bug.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>

#include "offline/cli/ask.h"
#include "offline/cli/calibrate_command.h"
#include "offline/cli/commands.h"
#include "offline/cli/echo.h"
#include "offline/cli/evaluate_command.h"
#include "offline/cli/inspect_command.h"
#include "offline/cli/synthesize_command.h"
#include "offline/cli/tune_command.h"
#include "runtime/base/error.h"
#include "runtime/base/version.h"

namespace {

int report(int code, const char* message) {
  std::fprintf(stderr, "sextant: %s\n", message);
  return code;
}

}  // namespace

int main(int argc, char** argv) {
  using sextant::ExitCode;
  int exit_code = static_cast<int>(ExitCode::kDone);
  CLI::App app("Finds known rigid objects on a table in one RGB-D frame: the offline toolchain.", "sextant");
  app.require_subcommand(1);
  app.set_version_flag("--version", sextant::kProgramVersion);
  sextant::add_compile_command(app, exit_code);
  sextant::add_inspect_command(app, exit_code);
  sextant::add_render_command(app, exit_code);
  sextant::add_detect_command(app, exit_code);
  sextant::add_verify_command(app, exit_code);
  sextant::add_calibrate_command(app, exit_code);
  sextant::add_evaluate_command(app, exit_code);
  sextant::add_synthesize_command(app, exit_code);
  sextant::add_tune_command(app, exit_code);
  sextant::add_echo_command(app, exit_code);
  sextant::add_ask_command(app, exit_code);
  sextant::add_record_command(app, exit_code);
  sextant::add_camera_command(app, exit_code);
  sextant::add_doctor_command(app, exit_code);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& e) {
    return app.exit(e);
  } catch (const CLI::ParseError& e) {
    app.exit(e);
    return static_cast<int>(ExitCode::kWrongUse);
  } catch (const sextant::DoorError& e) {
    return report(static_cast<int>(e.exit_code()), e.what());
  } catch (const std::exception& e) {
    return report(static_cast<int>(ExitCode::kOurBug),
                  (std::string("this is our bug, please report it: ") + e.what()).c_str());
  }
  return exit_code;
}
