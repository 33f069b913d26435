// SPDX-License-Identifier: Apache-2.0
// The part of the configuration that says where the table of a live source is known from.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hal/table/table_locator.h"
#include "runtime/daemon/config_field.h"

namespace sextant {

/// The values as the YAML file gives them.
struct TableConfig {
  std::string source = "detect";
  std::string gravity = "none";
  bool filter = true;
  double lowest_m = TableEstimateOptions().lowest_m;
  double highest_m = TableEstimateOptions().highest_m;
  std::string pose_topic;
  std::string world_frame = "base_link";
  double surface_height_m = 0;
  double max_age_ms = 200;
  double height_deviation_m = 0;
  double tilt_deviation_deg = 0;
};

ConfigSection table_section();
std::vector<ConfigField> table_fields(TableConfig& config);

/// Checks what no key can know alone. detect_table: the value of detect.table. Throws InputError(where).
void check_table_config(const TableConfig& config, const std::string& detect_table, const std::string& where);

/// What locates the table before detection; nothing where detect.table says it all. fixed: of the keys
/// detect.table_*.
std::optional<TableLocatorOptions> locator_options(const TableConfig& config, const TableGeometry& fixed,
                                                   unsigned domain);

}  // namespace sextant
