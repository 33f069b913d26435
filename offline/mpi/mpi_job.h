// SPDX-License-Identifier: Apache-2.0
// MPI's life as an object's.
#pragma once

#include <mpi.h>
#include <unistd.h>

#include <cstdio>

#include "runtime/base/error.h"

namespace sextant {

/// MPI for as long as it lives.
struct MpiJob {
  int rank = 0;
  int ranks = 1;
  /// Several threads may speak, one at a time.
  MpiJob() {
    int provided = 0;
    MPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &provided);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, &ranks);
  }
  ~MpiJob() { MPI_Finalize(); }
  MpiJob(const MpiJob&) = delete;
  MpiJob& operator=(const MpiJob&) = delete;
};

/// How a rank of a job that survives lost ranks ends. `job` is made with new and never by an exception's way
/// out: main() then aborts the job, where ending would wait for all ranks. together: no rank is lost.
/// elsewhere: one of another machine is, which only MPI_Abort gets rid of.
inline ExitCode leave_job(MpiJob* job, bool together, bool elsewhere, ExitCode code) {
  std::fflush(nullptr);
  if (together) {
    delete job;
    return code;
  }
  if (elsewhere) MPI_Abort(MPI_COMM_WORLD, static_cast<int>(code));
  _exit(static_cast<int>(code));
}

}  // namespace sextant
