// SPDX-License-Identifier: Apache-2.0
// Runs work that may crash, hang or eat memory in a child process, and brings its answer back. Mesh
// importers are large and were written for trusted files: what one of them does to itself must not reach us.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace sextant {

/// What the child may use before it is stopped.
struct IsolationLimits {
  double cpu_s = 120;                               ///< processor time
  double wall_s = 300;                              ///< elapsed time, for a child that sleeps
  std::size_t memory_bytes = std::size_t{4} << 30;  ///< address space beyond what the caller has now
  std::size_t answer_bytes = std::size_t{1} << 30;  ///< longest answer that is accepted
};

/// How the child ended.
struct IsolatedAnswer {
  std::vector<std::byte> bytes;  ///< what `work` returned; still untrusted
  std::string failure;           ///< empty: it ended well; else why not, e.g. "crashed (signal 11)"
};

/// Forks, runs `work` in the child with the limits and without standard streams or the right to write
/// files, and waits for its answer. Never throws for what the child does; throws DeviceError where no
/// process can be made. Other threads of the caller do not exist in the child: `work` must not need them.
IsolatedAnswer run_isolated(const std::function<std::vector<std::byte>()>& work,
                            const IsolationLimits& limits);

}  // namespace sextant
