// SPDX-License-Identifier: Apache-2.0
// The part of the configuration that concerns live cameras: a colour stream, a depth stream, and how the two
// become frames. Only read where source.kind is v4l2 or libcamera.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "hal/frame_source.h"
#include "runtime/daemon/config_field.h"

namespace sextant {

/// The values as the YAML file gives them.
struct LiveConfig {
  struct Stream {
    std::string device;
    std::string format = "auto";
    int width = 640;
    int height = 480;
    double rate_hz = 30;
    std::vector<std::string> controls;
    std::string camera;
  } colour, depth;

  std::string depth_encoding = "linear";
  double depth_nearest_m = 0.1;
  double depth_farthest_m = 10;
  bool depth_registered = false;
  std::vector<std::string> colour_from_depth;

  double pair_tolerance_ms = 17;
  bool shared_sequence = false;
  double watchdog_ms = 1000;
  int buffers = 4;
};

std::vector<ConfigSection> live_sections();
std::vector<ConfigField> live_fields(LiveConfig& config);

/// True for the kinds of source that this is about.
bool is_live(const std::string& source_kind);

/// Checks what can be checked without the devices. Throws InputError(where).
void check_live_config(const LiveConfig& config, const std::string& source_kind, const std::string& where);

/// Opens both streams; absent devices are waited for. `folder` is where relative paths start. Throws InputError
/// for calibrations, UsageError / DeviceError for what the devices do not offer.
std::unique_ptr<FrameSource> open_live_source(const LiveConfig& config, const std::string& source_kind,
                                              const std::filesystem::path& folder, const std::string& frame_id);

}  // namespace sextant
