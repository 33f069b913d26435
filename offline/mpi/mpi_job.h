// SPDX-License-Identifier: Apache-2.0
// MPI's life as an object's.
#pragma once

#include <mpi.h>

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

}  // namespace sextant
