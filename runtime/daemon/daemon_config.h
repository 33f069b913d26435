// SPDX-License-Identifier: Apache-2.0
// What sextantd can be told. config/sextantd.yaml documents every key.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "hal/sources/open_source.h"
#include "runtime/daemon/config_field.h"
#include "runtime/daemon/live_config.h"
#include "runtime/daemon/pipeline.h"
#include "runtime/daemon/table_config.h"
#include "runtime/detect/detector.h"
#include "runtime/publish/command_server.h"
#include "runtime/publish/publisher.h"

namespace sextant {

/// The values as the YAML file gives them: units of the file, paths relative to `folder`.
struct DaemonConfig {
  std::filesystem::path folder;  ///< of the YAML file: relative paths start here

  struct Source {
    std::string kind = "playback";
    std::string dataset;
    std::string split = "test";
    int scene = -1;
    int image = -1;
    double rate_hz = 0;
    bool loop = false;
    std::string frame_id = "camera_color_optical_frame";
  } source;

  LiveConfig live;
  TableConfig table;

  struct Models {
    std::vector<std::string> files;
  } models;

  struct Detect {
    std::string table = "frame";
    double table_pitch_deg = 30;
    double table_roll_deg = 0;
    double table_height_m = 0.5;
    double height_tolerance_m = TableTolerance().height_m;
    double angle_tolerance_deg = 12;
    int max_detections = DetectOptions().max_detections;
    int candidates = DetectOptions().candidates;
    std::optional<double> threshold = DetectOptions().threshold;
    bool refine = DetectOptions().refine;
    double false_positive_rate = DetectOptions().false_positive_rate;
    double deadline_ms = DetectOptions().deadline_ms;
    int threads = DetectOptions().threads;
    std::string scoring = DetectOptions().scoring;
    std::string bound = DetectOptions().bound;
    int search_width = DetectOptions().search_width;
    double min_distance_m = DetectOptions().min_distance_m;
    double max_distance_m = DetectOptions().max_distance_m;
    std::string region;
    std::string workspace;
    std::string camera_pose;
    bool runner_up = DetectOptions().runner_up;
    double runner_up_radius_m = DetectOptions().runner_up_radius_m;
    double runner_up_angle_deg = 30;
    std::optional<double> runner_up_most = DetectOptions().runner_up_most;
  } detect;

  struct Publish {
    int domain = -1;
    std::string name_space;
    std::string detections = PublisherOptions().detections_topic;
    std::string object_pose = PublisherOptions().object_pose_topic;
    std::string pose_estimates = PublisherOptions().pose_estimates_topic;
    std::string tf = PublisherOptions().tf_topic;
    std::string tf_prefix;
    std::string markers = PublisherOptions().markers_topic;
    std::string marker_shape = "mesh";
    std::string annotated = PublisherOptions().annotated_topic;
    std::string table_estimate = PublisherOptions().table_topic;
    std::string diagnostics = PublisherOptions().diagnostics_topic;
    double diagnostics_period_ms = 1000;
    double lease_ms = PublisherOptions().lease_ms;
    double once_wait_ms = 3000;
  } publish;

  struct Commands {
    std::string command = CommandServerOptions().command_topic;
    std::string answer = CommandServerOptions().answer_topic;
    double look_patience_ms = 10000;
  } commands;

  struct Flow {
    int queue_frames = PipelineOptions().queue_frames;
    double max_age_ms = PipelineOptions().max_age_ms;
    std::optional<double> max_frame_age_ms;
  } pipeline;

  struct Log {
    std::string level = "info";
  } log;
};

/// The sections and keys in the order of the file; the targets point into `config`.
std::vector<ConfigSection> config_sections();
std::vector<ConfigField> config_fields(DaemonConfig& config);

/// Checks what no key can know alone. Throws InputError(where).
void check_config(const DaemonConfig& config, const std::string& where);

/// The parts' own options.
SourceOptions source_options(const DaemonConfig& config);
DetectOptions detect_options(const DaemonConfig& config);
/// Nothing where detect.table says where the table is.
std::optional<TableLocatorOptions> table_options(const DaemonConfig& config);
PipelineOptions pipeline_options(const DaemonConfig& config);
/// object_shapes stays empty. Throws UsageError where ROS_DOMAIN_ID is needed and no number.
PublisherOptions publisher_options(const DaemonConfig& config);
CommandServerOptions command_options(const DaemonConfig& config);
/// The folders that models.files names, for commands that load models.
std::vector<std::filesystem::path> model_folders(const DaemonConfig& config);
/// The model files after expansion of *, ? and [], sorted. Throws InputError for a pattern without a file.
std::vector<std::filesystem::path> model_files(const DaemonConfig& config);

}  // namespace sextant
