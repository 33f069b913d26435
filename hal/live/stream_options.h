// SPDX-License-Identifier: Apache-2.0
// What a live stream is asked for; the same for every kind of device.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "hal/pixel_format.h"

namespace sextant {

struct StreamOptions {
  std::string device;           ///< an id or alias of CameraDevice
  bool depth = false;           ///< must be decodable as depth, else as colour
  std::string format = "auto";  ///< format_named(), or "auto": the first that fits
  int width = 640;              ///< pixels
  int height = 480;             ///< pixels
  double rate_hz = 0;           ///< 0: the device's own
  /// "name=value", set in this order before streaming; menu entries by number or text.
  std::vector<std::string> controls;
  int buffers = 4;                           ///< 2..32; the device fills what nobody holds
  bool export_dma_buf = false;               ///< give images a DMA-BUF where the driver can
  std::chrono::milliseconds watchdog{1000};  ///< no good frame for so long: the stream is opened anew
  std::chrono::milliseconds max_age{100};    ///< older images are dropped as stale; 0: none is
  bool newest_only = true;                   ///< hand out the newest image, else every one in order
  bool wait_for_device = false;              ///< an absent device is waited for at first, too
};

/// Throws UsageError for what no device could do.
void check_stream_options(const StreamOptions& options);

}  // namespace sextant
