// SPDX-License-Identifier: Apache-2.0
// sextant-mpi: the work that is worth several machines, over OpenMPI ranks. The only program that links MPI.
#include <mpi.h>

#include <CLI/CLI.hpp>
#include <cstdio>

#include "offline/mpi/mpi_compile.h"
#include "offline/mpi/mpi_detect.h"
#include "offline/mpi/mpi_serve.h"
#include "offline/mpi/mpi_tune.h"
#include "runtime/base/error.h"
#include "runtime/base/version.h"

namespace {

/// Ends all ranks with our exit code; only the first message is printed by the launcher's user anyway.
int fail(int code, const char* message) {
  std::fprintf(stderr, "sextant-mpi: %s\n", message);
  int running = 0;
  MPI_Initialized(&running);
  if (running) MPI_Abort(MPI_COMM_WORLD, code);
  return code;
}

}  // namespace

int main(int argc, char** argv) {
  using sextant::ExitCode;
  int exit_code = static_cast<int>(ExitCode::kDone);
  CLI::App app("Sextant over OpenMPI ranks: mpirun -n RANKS sextant-mpi ...", "sextant-mpi");
  app.require_subcommand(1);
  app.set_version_flag("--version", sextant::kProgramVersion);
  sextant::add_mpi_compile_command(app, exit_code);
  sextant::add_mpi_detect_command(app, exit_code);
  sextant::add_mpi_serve_command(app, exit_code);
  sextant::add_mpi_tune_command(app, exit_code);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& e) {
    return app.exit(e);
  } catch (const CLI::ParseError& e) {
    app.exit(e);
    return static_cast<int>(ExitCode::kWrongUse);
  } catch (const sextant::DoorError& e) {
    return fail(static_cast<int>(e.exit_code()), e.what());
  } catch (const std::exception& e) {
    return fail(static_cast<int>(ExitCode::kOurBug),
                (std::string("this is our bug, please report it: ") + e.what()).c_str());
  }
  return exit_code;
}
