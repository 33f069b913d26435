// SPDX-License-Identifier: Apache-2.0
// SIGINT and SIGTERM as a question: has the user had enough? For commands that wait.
#pragma once

#include <csignal>

namespace sextant {

/// While it lives, the two signals are only noted.
class StopOnSignal {
 public:
  StopOnSignal();
  ~StopOnSignal();
  StopOnSignal(const StopOnSignal&) = delete;
  StopOnSignal& operator=(const StopOnSignal&) = delete;
  bool requested() const;

 private:
  struct sigaction old_interrupt_ {};
  struct sigaction old_terminate_ {};
};

}  // namespace sextant
