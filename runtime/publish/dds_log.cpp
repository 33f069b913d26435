// SPDX-License-Identifier: Apache-2.0
#include "runtime/publish/dds_log.h"

#include <dds/ddsrt/log.h>
#include <fmt/format.h>

#include <chrono>
#include <mutex>
#include <string_view>
#include <utility>

#include "runtime/base/rate_limiter.h"

namespace sextant {

namespace {

constexpr int kLinesPerSecond = 10;

}  // namespace

struct DdsLog::Impl {
  std::function<void(const std::string&)> sink;
  std::mutex mutex;
  RateLimiter limiter{kLinesPerSecond, std::chrono::seconds(1)};

  static void receive(void* self, const dds_log_data_t* data) {
    auto& log = *static_cast<Impl*>(self);
    std::string_view line(data->message, data->size);
    while (!line.empty() && line.back() == '\n') line.remove_suffix(1);
    const std::lock_guard lock(log.mutex);
    std::uint64_t held_back = 0;
    if (!log.limiter.pass(std::chrono::steady_clock::now(), held_back)) return;
    log.sink(held_back == 0 ? std::string(line)
                            : fmt::format("{} ({} lines held back before)", line, held_back));
  }
};

DdsLog::DdsLog(std::function<void(const std::string&)> sink) : impl_(std::make_unique<Impl>()) {
  impl_->sink = std::move(sink);
  dds_set_log_mask(DDS_LC_FATAL | DDS_LC_ERROR | DDS_LC_WARNING);
  dds_set_log_sink(&Impl::receive, impl_.get());
  dds_set_trace_sink(&Impl::receive, impl_.get());
}

DdsLog::~DdsLog() {
  dds_set_log_sink(nullptr, nullptr);
  dds_set_trace_sink(nullptr, nullptr);
}

}  // namespace sextant
