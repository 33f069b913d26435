// SPDX-License-Identifier: Apache-2.0
// The life of a live stream, whatever its driver: opened, streaming, silent, gone, back. Used by the V4L2 and
// libcamera sources; tests drive it with scripted sessions.
#pragma once

#include <memory>
#include <string>

#include "hal/image_source.h"
#include "hal/live/stream_options.h"
#include "hal/live/stream_session.h"

namespace sextant {

/// Opens the first session here, in up to three tries while the device is unready. Throws what `open` throws
/// (DeviceUnready only without options.wait_for_device). From then on every failure is survived:
///  - a session that ends (unplugged, failed queue) is opened anew, with back-off, until close();
///  - no good frame for options.watchdog (while buffers are queued): likewise;
///  - damaged, stale, superseded and untimed frames are counted and never handed out;
///  - gaps in the device's numbers are counted as lost.
std::unique_ptr<ImageSource> make_live_source(std::string name, const StreamOptions& options,
                                              OpenSession open);

}  // namespace sextant
