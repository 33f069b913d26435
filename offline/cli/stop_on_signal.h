// SPDX-License-Identifier: Apache-2.0
// Ctrl-C ends the work instead of the process: what was done so far is finished and said.
#pragma once

namespace sextant {

/// While it lives, SIGINT and SIGTERM set a flag. One per process.
class StopOnSignal {
 public:
  StopOnSignal();
  ~StopOnSignal();
  StopOnSignal(const StopOnSignal&) = delete;
  StopOnSignal& operator=(const StopOnSignal&) = delete;
  bool requested() const;
};

}  // namespace sextant
