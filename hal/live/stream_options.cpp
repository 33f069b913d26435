// SPDX-License-Identifier: Apache-2.0
#include "hal/live/stream_options.h"

#include <fmt/format.h>

#include "runtime/base/error.h"

namespace sextant {
namespace {

void require(bool good, const StreamOptions& options, const char* what, const char* advice) {
  if (!good) throw UsageError(fmt::format("stream of '{}': {}", options.device, what), advice);
}

}  // namespace

void check_stream_options(const StreamOptions& options) {
  require(!options.device.empty(), options, "no device is named", "`sextant camera list` shows them");
  require(options.width >= 16 && options.width <= 16384 && options.height >= 16 && options.height <= 16384,
          options, "the size is out of range", "sides may be 16 to 16384");
  require(options.rate_hz >= 0 && options.rate_hz <= 1000, options, "the rate is out of range",
          "0 (the device's own) to 1000 Hz");
  require(options.buffers >= 2 && options.buffers <= 32, options, "the number of buffers is out of range",
          "2 to 32");
  require(options.watchdog.count() >= 50 && options.watchdog.count() <= 600000, options,
          "the watchdog is out of range", "50 to 600000 ms");
  require(options.max_age.count() >= 0, options, "the largest age is negative", "0 or more");
  if (options.format == "auto") return;
  const auto format = format_named(options.format);
  require(format.has_value(), options, "the format is unknown",
          "use auto, YUYV, UYVY, NV12, MJPG, RGB3, BGR3, GREY, Z16, Y16, Y10, Y12, Y10B or Y11B");
  const PixelFormatInfo& info = info_of(*format);
  require(options.depth ? info.is_depth : info.is_colour, options,
          options.depth ? "the format holds no depth" : "the format holds no colour",
          options.depth ? "use auto, Z16, Y16, Y10, Y12, Y10B or Y11B"
                        : "use auto, YUYV, UYVY, NV12, MJPG, RGB3, BGR3 or GREY");
}

}  // namespace sextant
