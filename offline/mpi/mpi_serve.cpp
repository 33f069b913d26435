// SPDX-License-Identifier: Apache-2.0
#include "offline/mpi/mpi_serve.h"

#include <mpi.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <string_view>
#include <thread>

#include "offline/mpi/mpi_job.h"
#include "offline/mpi/search_coordinator.h"
#include "offline/mpi/search_worker.h"
#include "runtime/base/error.h"
#include "runtime/daemon/config_reader.h"
#include "runtime/daemon/serve.h"

namespace sextant {
namespace {

struct MpiServeArguments {
  ServeArguments serve;
  CoordinatorOptions coordinator;
};

/// The other ranks, as the daemon sees them. The daemon's detection and the sign of life come from two
/// threads of which one at a time speaks.
class OtherRanks {
 public:
  OtherRanks(int ranks, const CoordinatorOptions& options) : coordinator_(ranks, options) {}
  ~OtherRanks() {
    {
      const std::lock_guard lock(sleep_mutex_);
      ending_ = true;
    }
    wake_.notify_all();
    alive_.join();
    coordinator_.end();
  }
  OtherRanks(const OtherRanks&) = delete;
  OtherRanks& operator=(const OtherRanks&) = delete;

  void share(const RgbdFrame& frame, const std::shared_ptr<const Detector>& detector, DetectCall& call) {
    const std::lock_guard lock(mutex_);
    if (detector != told_) {
      coordinator_.send_setup(*detector);
      told_ = detector;
    }
    coordinator_.send_frame(frame, call, detector->models());
    call.search = [this, &frame, detector](const LaneSearchProblem& problem, const DetectCall& asked) {
      const std::lock_guard held(mutex_);
      if (!asked.further.empty()) coordinator_.send_frame(frame, asked, detector->models());
      return coordinator_.run(problem);
    };
  }

  std::size_t lost() const { return coordinator_.lost(); }
  bool lost_elsewhere() const { return coordinator_.lost_elsewhere(); }

 private:
  void keep_alive() {
    std::unique_lock sleep(sleep_mutex_);
    while (!wake_.wait_for(sleep, std::chrono::seconds(10), [this] { return ending_; })) {
      const std::lock_guard lock(mutex_);
      coordinator_.keep_alive();
    }
  }

  std::mutex mutex_;  ///< guards coordinator_
  SearchCoordinator coordinator_;
  std::shared_ptr<const Detector> told_;  ///< whose models and options the others have
  std::mutex sleep_mutex_;                ///< guards ending_
  std::condition_variable wake_;
  bool ending_ = false;
  std::thread alive_{[this] { keep_alive(); }};
};

ExitCode run(const MpiServeArguments& a) {
  spdlog::set_default_logger(spdlog::stderr_color_mt("sextant-mpi"));
  spdlog::set_pattern("%Y-%m-%dT%H:%M:%S.%e %^%l%$ %v");
  // Before MPI's threads exist. Signals are for rank 0; it tells the others.
  SignalWaiter signals;
  if (a.serve.check_config || a.serve.reference || a.serve.config.empty()) {
    serve(a.serve, signals);
    return ExitCode::kDone;
  }
  // A bad configuration is one clear line, before MPI starts. Other ranks need not have it.
  const char* rank = std::getenv("OMPI_COMM_WORLD_RANK");
  if (rank == nullptr || std::string_view(rank) == "0") read_config(a.serve.config);
  auto* job = new MpiJob;
  // A rank that dies is the coordinator's business, not the end (with mpirun --enable-recovery).
  MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN);
  if (job->rank != 0) {
    return leave_job(job, work_for_coordinator(job->rank, {}), false, ExitCode::kDone);
  }
  std::size_t lost = 0;
  bool elsewhere = false;
  {
    OtherRanks others(job->ranks, a.coordinator);
    serve(a.serve, signals,
          [&](const RgbdFrame& frame, const std::shared_ptr<const Detector>& detector, DetectCall& call) {
            others.share(frame, detector, call);
          });
    lost = others.lost();
    elsewhere = others.lost_elsewhere();
  }
  return leave_job(job, lost == 0, elsewhere, ExitCode::kDone);
}

}  // namespace

CLI::App* add_mpi_serve_command(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<MpiServeArguments>();
  CLI::App* command = app.add_subcommand("serve", "the daemon sextantd, its search spread over all ranks");
  arguments->serve.add_to(*command);
  command->footer(
      "Rank 0 has the camera and DDS; the others only search and need nothing but the program.\n"
      "Start with --enable-recovery, so that a rank that dies does not end the daemon.\n"
      "Example:\n  mpirun --enable-recovery -n 4 sextant-mpi serve --config config/sextantd.yaml\n" +
      command->get_footer());
  command
      ->add_option("--lost-after-s", arguments->coordinator.lost_after_s,
                   "a rank that is silent for so long is given up and its boxes are searched by others")
      ->check(CLI::Range(0.1, 3600.0))
      ->capture_default_str();
  command->callback([arguments, &exit_code] { exit_code = static_cast<int>(run(*arguments)); });
  return command;
}

}  // namespace sextant
