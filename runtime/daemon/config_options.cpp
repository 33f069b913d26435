// SPDX-License-Identifier: Apache-2.0
// From the file's units and paths to the options of each part.
#include <fmt/format.h>
#include <glob.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <numbers>
#include <set>

#include "runtime/base/error.h"
#include "runtime/daemon/daemon_config.h"
#include "runtime/publish/topics.h"

namespace sextant {

namespace {

constexpr double kRadiansPerDegree = std::numbers::pi / 180;
constexpr std::size_t kMostModels = 1000;
/// An older frame shows where the object was.
constexpr double kLargestLiveAgeMs = 100;

TableSource table_source(const std::string& name) {
  if (name == "none") return TableSource::kNone;
  if (name == "estimate") return TableSource::kEstimate;
  if (name == "fixed") return TableSource::kFixed;
  return TableSource::kFrame;
}

void check_topics(const DaemonConfig& config, const std::string& where) {
  const auto& p = config.publish;
  std::set<std::string> seen;
  for (const std::string& topic :
       {p.detections, p.object_pose, p.pose_estimates, p.tf, p.markers, p.annotated, p.table_estimate,
        p.diagnostics, config.commands.command, config.commands.answer}) {
    if (topic.empty()) continue;
    std::string full;
    try {
      full = dds_topic_name(p.name_space, topic);
    } catch (const UsageError&) {
      throw InputError(where, "publish.namespace and a topic are too long together",
                       "use at most 200 characters");
    }
    if (!seen.insert(full).second) {
      throw InputError(where, "two topics have the same name: " + full.substr(3),
                       "give each its own, or \"\" for off");
    }
  }
}

unsigned domain_of(const DaemonConfig& config) {
  if (config.publish.domain >= 0) return static_cast<unsigned>(config.publish.domain);
  const char* text = std::getenv("ROS_DOMAIN_ID");
  if (text == nullptr || *text == '\0') return 0;
  unsigned domain = 0;
  const char* end = text + std::strlen(text);
  const auto [stop, error] = std::from_chars(text, end, domain);
  if (error != std::errc() || stop != end) {
    throw UsageError(fmt::format("ROS_DOMAIN_ID is '{}', no number", text),
                     "set it to 0..230, or publish.domain");
  }
  check_domain(domain);
  return domain;
}

}  // namespace

void check_config(const DaemonConfig& config, const std::string& where) {
  check_live_config(config.live, config.source.kind, where);
  check_table_config(config.table, config.detect.table, where);
  if (is_live(config.source.kind) && config.detect.table == "frame" && config.table.source == "detect") {
    throw InputError(where, "detect.table is frame, but a camera does not say where the table is",
                     "set table.source, or use estimate, or fixed with the table_ keys");
  }
  if (!is_live(config.source.kind) && config.source.dataset.empty()) {
    throw InputError(where, "source.dataset is missing", "give the folder of a BOP data set");
  }
  if (config.models.files.empty()) {
    throw InputError(where, "models.files is empty", "give at least one model made by `sextant compile`");
  }
  if (config.detect.min_distance_m >= config.detect.max_distance_m) {
    throw InputError(where, "detect.min_distance_m is not below detect.max_distance_m", "swap or widen them");
  }
  if (config.detect.search_width != 0 && config.detect.search_width < 64) {
    throw InputError(where, "detect.search_width is below 64",
                     "use 0 for the frame's own width, or 64..4096");
  }
  try {
    region_from_text(config.detect.region, config.detect.workspace, config.detect.camera_pose);
  } catch (const UsageError& e) {
    throw InputError(where, std::string("detect.region, workspace, camera_pose: ") + e.what());
  }
  if (!config.detect.workspace.empty() && config.detect.camera_pose.empty() &&
      config.detect.table == "none") {
    throw InputError(where, "detect.workspace is in the table's frame, but detect.table is none",
                     "give detect.camera_pose, or let the table be known");
  }
  check_topics(config, where);
}

SourceOptions source_options(const DaemonConfig& config) {
  SourceOptions options;
  options.kind = config.source.kind;
  options.frame_id = config.source.frame_id;
  PlaybackOptions& playback = options.playback;
  playback.dataset = (config.folder / config.source.dataset).lexically_normal();
  playback.split = config.source.split;
  playback.scene = config.source.scene;
  playback.image = config.source.image;
  playback.rate_hz = config.source.rate_hz;
  playback.loop = config.source.loop;
  playback.frame_id = config.source.frame_id;
  if (!is_live(config.source.kind)) return options;
  add_live_options(config.live, config.source.kind, options);
  if (!config.live.rig.empty()) options.rig = (config.folder / config.live.rig).lexically_normal();
  if (config.source.kind == "dds") options.dds.domain = domain_of(config);
  return options;
}

DetectOptions detect_options(const DaemonConfig& config) {
  const DaemonConfig::Detect& d = config.detect;
  DetectOptions options;
  options.table = table_source(d.table);
  options.fixed_table = TableGeometry::from_pitch_roll(
      d.table_pitch_deg * kRadiansPerDegree, d.table_roll_deg * kRadiansPerDegree, d.table_height_m);
  options.tolerance = {d.height_tolerance_m, d.angle_tolerance_deg * kRadiansPerDegree};
  options.max_detections = d.max_detections;
  options.candidates = d.candidates;
  options.threshold = d.threshold;
  options.refine = d.refine;
  options.false_positive_rate = d.false_positive_rate;
  options.deadline_ms = d.deadline_ms;
  options.threads = d.threads;
  options.scoring = d.scoring;
  options.bound = d.bound;
  options.search_width = d.search_width;
  options.min_distance_m = d.min_distance_m;
  options.max_distance_m = d.max_distance_m;
  options.region = region_from_text(d.region, d.workspace, d.camera_pose);
  options.runner_up = d.runner_up;
  options.runner_up_radius_m = d.runner_up_radius_m;
  options.runner_up_angle_rad = d.runner_up_angle_deg * kRadiansPerDegree;
  options.runner_up_most = d.runner_up_most.value_or(std::numeric_limits<double>::infinity());
  return options;
}

std::optional<TableLocatorOptions> table_options(const DaemonConfig& config) {
  return locator_options(config.table, detect_options(config).fixed_table, domain_of(config));
}

PipelineOptions pipeline_options(const DaemonConfig& config) {
  PipelineOptions options;
  options.queue_frames = config.pipeline.queue_frames;
  options.max_age_ms = config.pipeline.max_age_ms;
  const bool live = is_live(config.source.kind);
  options.max_frame_age_ms = config.pipeline.max_frame_age_ms.value_or(live ? kLargestLiveAgeMs : 0);
  options.skip_none = config.source.kind == "playback" && config.source.rate_hz == 0;
  return options;
}

PublisherOptions publisher_options(const DaemonConfig& config) {
  PublisherOptions options;
  options.domain = domain_of(config);
  options.name_space = config.publish.name_space;
  options.detections_topic = config.publish.detections;
  options.object_pose_topic = config.publish.object_pose;
  options.pose_estimates_topic = config.publish.pose_estimates;
  options.tf_topic = config.publish.tf;
  options.tf_prefix = config.publish.tf_prefix;
  options.markers_topic = config.publish.markers;
  options.marker_mesh = config.publish.marker_shape == "mesh";
  options.annotated_topic = config.publish.annotated;
  options.table_topic = config.publish.table_estimate;
  options.diagnostics_topic = config.publish.diagnostics;
  options.lease_ms = config.publish.lease_ms;
  options.max_age_ms = config.pipeline.max_age_ms;
  return options;
}

CommandServerOptions command_options(const DaemonConfig& config) {
  return {config.publish.name_space, config.commands.command, config.commands.answer};
}

std::vector<std::filesystem::path> model_folders(const DaemonConfig& config) {
  std::set<std::filesystem::path> folders;
  for (const std::string& pattern : config.models.files)
    folders.insert((config.folder / pattern).lexically_normal().parent_path());
  return {folders.begin(), folders.end()};
}

std::vector<std::filesystem::path> model_files(const DaemonConfig& config) {
  std::vector<std::filesystem::path> files;
  for (const std::string& pattern : config.models.files) {
    const std::string path = (config.folder / pattern).lexically_normal().string();
    glob_t found{};
    const int code = glob(path.c_str(), 0, nullptr, &found);
    for (std::size_t i = 0; code == 0 && i < found.gl_pathc; ++i) files.emplace_back(found.gl_pathv[i]);
    globfree(&found);
    if (code == GLOB_NOMATCH)
      throw InputError(path, "there is no such model", "make one with `sextant compile`");
    if (code != 0) throw InputError(path, "cannot look for models", "check the folder and its permissions");
  }
  std::sort(files.begin(), files.end());
  files.erase(std::unique(files.begin(), files.end()), files.end());
  if (files.size() > kMostModels) {
    throw InputError("models.files", fmt::format("{} models", files.size()), "use at most 1000");
  }
  return files;
}

}  // namespace sextant
