// SPDX-License-Identifier: Apache-2.0
#include "runtime/daemon/service_notifier.h"

#include <systemd/sd-daemon.h>

#include <cstdint>

namespace sextant {

ServiceNotifier::ServiceNotifier() {
  std::uint64_t microseconds = 0;
  if (sd_watchdog_enabled(0, &microseconds) > 0) {
    // Frames come faster than this; more messages would say nothing more.
    watchdog_interval_ = std::chrono::microseconds(microseconds) / 8;
  }
}

void ServiceNotifier::ready() const { sd_notify(0, "READY=1"); }

void ServiceNotifier::reloading() const {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  const auto us = std::chrono::duration_cast<std::chrono::microseconds>(now).count();
  sd_notifyf(0, "RELOADING=1\nMONOTONIC_USEC=%lld", static_cast<long long>(us));
}

void ServiceNotifier::progress() {
  if (watchdog_interval_ == std::chrono::steady_clock::duration::zero()) return;
  const auto now = std::chrono::steady_clock::now();
  if (now - last_ < watchdog_interval_) return;
  last_ = now;
  sd_notify(0, "WATCHDOG=1");
}

void ServiceNotifier::alive() const { sd_notify(0, "WATCHDOG=1"); }

void ServiceNotifier::stopping() const { sd_notify(0, "STOPPING=1"); }

void ServiceNotifier::status(const std::string& line) const { sd_notify(0, ("STATUS=" + line).c_str()); }

}  // namespace sextant
