// SPDX-License-Identifier: Apache-2.0
// The subcommands of `sextant`. Each adds itself to the application and stores its exit code when it is run;
// errors leave as DoorError and are printed in one place (main.cpp).
#pragma once

#include <CLI/CLI.hpp>

namespace sextant {

CLI::App* add_compile_command(CLI::App& app, int& exit_code);
CLI::App* add_camera_command(CLI::App& app, int& exit_code);
CLI::App* add_detect_command(CLI::App& app, int& exit_code);
CLI::App* add_doctor_command(CLI::App& app, int& exit_code);
CLI::App* add_record_command(CLI::App& app, int& exit_code);
CLI::App* add_render_command(CLI::App& app, int& exit_code);
CLI::App* add_verify_command(CLI::App& app, int& exit_code);

}  // namespace sextant
