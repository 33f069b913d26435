// SPDX-License-Identifier: Apache-2.0
// The part of the configuration that concerns cameras: which streams, and how they are watched.
#pragma once

#include <string>
#include <vector>

#include "hal/sources/open_source.h"
#include "runtime/daemon/config_field.h"

namespace sextant {

/// The values as the YAML file gives them.
struct LiveConfig {
  struct Stream {
    std::string device;
    std::string topic;
    std::string format = "auto";
    double rate_hz = 30;
    std::vector<std::string> controls;
  } colour, depth;

  std::string rig;
  bool rectify = true;
  int width = 0;
  double max_age_ms = 100;
  bool stamp_on_arrival = false;
  double watchdog_ms = 1000;
  int buffers = 4;
};

std::vector<ConfigSection> live_sections();
std::vector<ConfigField> live_fields(LiveConfig& config);

/// True for the kinds of source that this is about: v4l2, libcamera, dds.
bool is_live(const std::string& source_kind);

/// Checks what can be checked without devices and files. Throws InputError(where).
void check_live_config(const LiveConfig& config, const std::string& source_kind, const std::string& where);

/// Fills what concerns cameras; rig is left to the caller, who knows where relative paths start.
void add_live_options(const LiveConfig& config, const std::string& source_kind, SourceOptions& options);

}  // namespace sextant
