// SPDX-License-Identifier: Apache-2.0
#include "offline/cli/stop_on_signal.h"

#include <csignal>

namespace sextant {
namespace {

/// Set by a signal; a handler can reach nothing but a global.
volatile std::sig_atomic_t stop = 0;

struct sigaction old_interrupt {};
struct sigaction old_terminate {};

}  // namespace

StopOnSignal::StopOnSignal() {
  stop = 0;
  struct sigaction action {};
  action.sa_handler = [](int) { stop = 1; };
  sigaction(SIGINT, &action, &old_interrupt);
  sigaction(SIGTERM, &action, &old_terminate);
}

StopOnSignal::~StopOnSignal() {
  sigaction(SIGINT, &old_interrupt, nullptr);
  sigaction(SIGTERM, &old_terminate, nullptr);
}

bool StopOnSignal::requested() const { return stop != 0; }

}  // namespace sextant
