// SPDX-License-Identifier: Apache-2.0
#include "offline/mpi/mpi_detect.h"

#include <mpi.h>

#include <cstdio>
#include <memory>

#include "offline/cli/detect_command.h"
#include "offline/mpi/mpi_job.h"
#include "offline/mpi/search_coordinator.h"
#include "offline/mpi/search_worker.h"
#include "runtime/base/error.h"
#include "runtime/model/model_file.h"

namespace sextant {
namespace {

struct MpiDetectArguments {
  DetectArguments detect;
  CoordinatorOptions coordinator;
  std::string fault;
};

/// "RANK:NODES:SIGNAL".
InjectedFault fault_from(const std::string& text) {
  InjectedFault fault;
  unsigned long long nodes = 0;
  if (text.empty()) return fault;
  if (std::sscanf(text.c_str(), "%d:%llu:%d", &fault.rank, &nodes, &fault.signal) != 3) {
    throw UsageError("--inject-fault " + text + " is not RANK:NODES:SIGNAL");
  }
  fault.nodes = nodes;
  return fault;
}

ExitCode run(const MpiDetectArguments& a) {
  // Everything that may refuse the input comes before MPI starts, so that a bad option is one clear line.
  const DetectOptions options = a.detect.options();
  const InjectedFault fault = fault_from(a.fault);
  if (options.bound != "lanes") throw UsageError("over ranks there is only --bound lanes");
  if (!a.detect.proof.empty()) throw UsageError("--proof is for sextant detect");
  std::vector<ObjectModel> models;
  for (const auto& file : a.detect.models) models.push_back(read_model(file));
  auto* job = new MpiJob;
  // A rank that dies is the coordinator's business, not the end (with mpirun --enable-recovery).
  MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN);
  if (job->rank != 0) {
    return leave_job(job, work_for_coordinator(job->rank, fault), false, ExitCode::kDone);
  }
  SearchCoordinator coordinator(job->ranks, a.coordinator);
  const Detector detector(std::move(models), options);
  coordinator.send_setup(detector);
  const ExitCode code = run_detect(a.detect, [&](const RgbdFrame& frame, DetectCall& call) {
    coordinator.send_frame(frame, call, detector.models());
    call.search = [&](const LaneSearchProblem& problem, const DetectCall& asked) {
      if (!asked.further.empty()) coordinator.send_frame(frame, asked, detector.models());
      return coordinator.run(problem);
    };
  });
  coordinator.end();
  return leave_job(job, coordinator.lost() == 0, coordinator.lost_elsewhere(), code);
}

}  // namespace

CLI::App* add_mpi_detect_command(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<MpiDetectArguments>();
  arguments->detect.detect.threads = 1;
  CLI::App* command =
      app.add_subcommand("detect", "poses for a BOP data set or a frame, searched by all ranks");
  command->footer(
      "Start with --enable-recovery, so that a rank that dies does not end the job.\n"
      "Example:\n  mpirun --enable-recovery -n 4 sextant-mpi detect mug.sxm --dataset data/sample");
  arguments->detect.add_to(*command);
  command
      ->add_option("--lost-after-s", arguments->coordinator.lost_after_s,
                   "a rank that is silent for so long is given up and its boxes are searched by others")
      ->check(CLI::Range(0.1, 3600.0))
      ->capture_default_str();
  command->add_flag("--verbose", arguments->coordinator.verbose, "say on stderr what is moved between ranks");
  command->add_option("--inject-fault", arguments->fault,
                      "RANK:NODES:SIGNAL: for tests, a rank sends itself a signal after so many nodes");
  command->callback([arguments, &exit_code] { exit_code = static_cast<int>(run(*arguments)); });
  return command;
}

}  // namespace sextant
