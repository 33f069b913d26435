// SPDX-License-Identifier: Apache-2.0
// Learning in parallel by processes, not threads: Mesa's software rasteriser compiles shaders behind every
// context's back and was seen to crash when two threads render at once; processes share nothing.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace sextant {

/// What a worker calls with each finished item.
using Deliver = std::function<void(std::size_t item, std::span<const std::byte> bytes)>;

/// Forks `count` workers; worker w runs work(w, deliver) and every delivered item arrives in `receive` in the
/// caller's process (one at a time, in any order). Returns when all workers have ended well. A DoorError of a
/// worker is thrown again here as InputError with its message; a worker that dies is a DeviceError. Other
/// threads of the caller do not exist in the workers.
void run_worker_processes(int count, const std::function<void(int worker, const Deliver&)>& work,
                          const Deliver& receive);

}  // namespace sextant
