// SPDX-License-Identifier: Apache-2.0
#include "runtime/daemon/table_config.h"

#include <cmath>
#include <numbers>

#include "hal/dds/subscription.h"
#include "runtime/base/error.h"

namespace sextant {
namespace {

bool is_topic_or_empty(const std::string& name) { return name.empty() || is_ros_topic(name); }

}  // namespace

ConfigSection table_section() {
  return {"table", "Where the table is, for every frame before it is searched (docs/cameras.md)."};
}

std::vector<ConfigField> table_fields(TableConfig& c) {
  return {
      {.section = "table",
       .key = "source",
       .target = &c.source,
       .text =
           "detect: detect.table says it all. estimate: fitted to each depth image and followed over time; "
           "dds: from the camera's pose in a frame whose z points up; fixed: the keys detect.table_* with "
           "the deviations below. All but detect need detect.table: frame, and widen the search by what "
           "is not known of the table.",
       .choices = {"detect", "estimate", "dds", "fixed"}},
      {.section = "table",
       .key = "gravity",
       .target = &c.gravity,
       .text = "For estimate: planes that are not level are left out. fixed: detect.table_pitch_deg and "
               "table_roll_deg say which way is up, within 15 degrees; dds: the camera's pose says it.",
       .choices = {"none", "fixed", "dds"}},
      {.section = "table",
       .key = "filter",
       .target = &c.filter,
       .text =
           "For estimate: average while the camera stands, ignore single outliers, begin again when it has "
           "moved. Without it every frame stands for itself."},
      {.section = "table",
       .key = "lowest_m",
       .target = &c.lowest_m,
       .text = "For estimate: least height of the camera above the table. Tells the table from the floor.",
       .unit = "m",
       .lowest = 0.01,
       .highest = 20},
      {.section = "table",
       .key = "highest_m",
       .target = &c.highest_m,
       .text = "For estimate: greatest height.",
       .unit = "m",
       .lowest = 0.01,
       .highest = 20},
      {.section = "table",
       .key = "pose_topic",
       .target = &c.pose_topic,
       .text =
           "For dds: topic of a geometry_msgs/PoseStamped, the camera's optical frame in world_frame. \"\" "
           "takes tf and tf_static from world_frame to source.frame_id.",
       .accepts = is_topic_or_empty,
       .accepted_form = "a topic name (letters, digits, _ and /, not starting with / or a digit) or \"\""},
      {.section = "table",
       .key = "world_frame",
       .target = &c.world_frame,
       .text = "For dds: a frame whose z points up."},
      {.section = "table",
       .key = "surface_height_m",
       .target = &c.surface_height_m,
       .text = "For dds: height of the table's surface in world_frame.",
       .unit = "m",
       .lowest = -100,
       .highest = 100},
      {.section = "table",
       .key = "max_age_ms",
       .target = &c.max_age_ms,
       .text = "For dds: a pose that is older than this when the frame was captured is not used.",
       .unit = "ms",
       .lowest = 1,
       .highest = 600000},
      {.section = "table",
       .key = "height_deviation_m",
       .target = &c.height_deviation_m,
       .text =
           "For dds and fixed: how well the height is known, one standard deviation. The search widens by "
           "twice of it.",
       .unit = "m",
       .lowest = 0,
       .highest = 1},
      {.section = "table",
       .key = "tilt_deviation_deg",
       .target = &c.tilt_deviation_deg,
       .text = "For dds and fixed: how well the direction of gravity is known, likewise.",
       .unit = "degrees",
       .lowest = 0,
       .highest = 20},
  };
}

void check_table_config(const TableConfig& config, const std::string& detect_table,
                        const std::string& where) {
  if (config.source != "detect" && detect_table != "frame") {
    throw InputError(where, "table.source is " + config.source + ", but detect.table is " + detect_table,
                     "set detect.table to frame: the frames carry the table then");
  }
  if (config.lowest_m >= config.highest_m) {
    throw InputError(where, "table.lowest_m is not below table.highest_m", "swap or widen them");
  }
}

std::optional<TableLocatorOptions> locator_options(const TableConfig& c, const TableGeometry& fixed,
                                                   unsigned domain) {
  if (c.source == "detect") return std::nullopt;
  TableLocatorOptions o;
  o.origin = c.source == "dds"     ? TableOrigin::kDds
             : c.source == "fixed" ? TableOrigin::kFixed
                                   : TableOrigin::kEstimate;
  o.fixed = fixed;
  o.height_deviation_m = c.height_deviation_m;
  o.tilt_deviation_rad = c.tilt_deviation_deg * std::numbers::pi / 180;
  o.domain = domain;
  o.pose_topic = c.pose_topic;
  o.world_frame = c.world_frame;
  o.table_height_m = c.surface_height_m;
  o.max_age = std::chrono::milliseconds(std::llround(c.max_age_ms));
  o.estimate.lowest_m = c.lowest_m;
  o.estimate.highest_m = c.highest_m;
  o.prior = c.gravity == "dds"     ? TableLocatorOptions::Prior::kDds
            : c.gravity == "fixed" ? TableLocatorOptions::Prior::kFixed
                                   : TableLocatorOptions::Prior::kNone;
  o.filter = c.filter;
  return o;
}

}  // namespace sextant
