// SPDX-License-Identifier: Apache-2.0
// A rank that searches for the coordinator (WORKER, Davies 2015, Procs. 32-33): a private queue that starts
// with its share of the roots, status messages with the measured rate, and whatever the coordinator asks.
#pragma once

#include <cstdint>

namespace sextant {

/// For tests: a rank that sends itself a signal after so many expanded nodes.
struct InjectedFault {
  int rank = -1;
  std::uint64_t nodes = 0;
  int signal = 0;
};

/// Searches frames until the coordinator ends the job. True: all ranks are there to end together. Throws
/// DeviceError where the coordinator falls silent.
bool work_for_coordinator(int rank, const InjectedFault& fault);

}  // namespace sextant
