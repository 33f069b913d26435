// SPDX-License-Identifier: Apache-2.0
#include "offline/mpi/mpi_tune.h"

#include <memory>

#include "offline/cli/tune_options.h"
#include "offline/mpi/mpi_job.h"
#include "runtime/base/error.h"

namespace sextant {
namespace {

void run(const TuneArguments& a) {
  // Everything that may refuse the input comes before MPI starts, so that bad input is one clear line.
  PreparedTuning tuning = prepare_tuning(a);
  const MpiJob job;
  tuning.run.first = static_cast<std::size_t>(job.rank);
  tuning.run.stride = static_cast<std::size_t>(job.ranks);
  run_share(tuning.run, tuning.trial);
  MPI_Barrier(MPI_COMM_WORLD);
  if (job.rank != 0) return;
  // Every answer is in the folder by now, but for the few that depend on all.
  report_tuning(a, tuning, finish_run(tuning.run, tuning.trial));
}

}  // namespace

CLI::App* add_mpi_tune_command(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<TuneArguments>();
  arguments->threads = 1;
  CLI::App* command = app.add_subcommand("tune", "a parameter sweep, points spread over the ranks");
  command->footer(
      "Example:\n  mpirun -n 4 sextant-mpi tune mug.stl --units mm --dataset labelled -o tuning --sweep "
      "visual_radius_px=4,6,8,10");
  arguments->add_to(*command);
  command->callback([arguments, &exit_code] {
    run(*arguments);
    exit_code = static_cast<int>(ExitCode::kDone);
  });
  return command;
}

}  // namespace sextant
