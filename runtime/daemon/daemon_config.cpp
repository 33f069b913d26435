// SPDX-License-Identifier: Apache-2.0
#include "runtime/daemon/daemon_config.h"

#include "runtime/publish/topics.h"

namespace sextant {

namespace {

bool is_name_or_empty(const std::string& name) { return name.empty() || is_topic_name(name); }
bool is_topic_or_empty(const std::string& name) { return name.empty() || is_topic_path(name); }
bool is_file_name(const std::string& name) {
  return !name.empty() && name.find_first_of("/\\") == std::string::npos && name != "." && name != "..";
}
bool is_frame_id(const std::string& name) {
  return !name.empty() && name.size() <= 200 &&
         name.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_/-.") ==
             std::string::npos;
}

bool is_frame_prefix(const std::string& name) { return name.empty() || is_frame_id(name); }

constexpr char kNameForm[] = "a name (letters, digits, _ and /, not starting with / or a digit) or \"\"";
constexpr char kTopicForm[] =
    "a topic name (letters, digits, _ and /, no digit after a /; a leading / leaves the namespace out) or "
    "\"\"";

}  // namespace

std::vector<ConfigSection> config_sections() {
  std::vector<ConfigSection> sections{
      {"source", "Where frames come from."},
      {"models", "What to look for."},
      {"detect", "How to look: the same options as `sextant detect`."},
      {"publish", "Where poses go: DDS topics as ROS 2 names them (docs/consume-poses.md)."},
      {"commands", "What a running daemon can be asked over DDS (docs/consume-poses.md, `sextant ask`)."},
      {"pipeline", "From frames to poses in time."},
      {"log", "Lines on stderr."},
  };
  const std::vector<ConfigSection> live = live_sections();
  sections.insert(sections.begin() + 1, table_section());
  sections.insert(sections.begin() + 1, live.begin(), live.end());
  return sections;
}

std::vector<ConfigField> config_fields(DaemonConfig& c) {
  std::vector<ConfigField> fields{
      {.section = "source",
       .key = "kind",
       .target = &c.source.kind,
       .text = "The kind of source. playback plays a data set as if it were a camera; every frame is stamped "
               "with "
               "the time at which it is played. v4l2: a colour and a depth camera of this machine; "
               "libcamera: the "
               "same, colour through libcamera; dds: the images of a ROS 2 camera driver.",
       .choices = {"playback", "v4l2", "libcamera", "dds"}},
      {.section = "source",
       .key = "dataset",
       .target = &c.source.dataset,
       .text = "playback: folder of the data set (BOP, TUM RGB-D, or a recording). Relative paths start at "
               "this file's folder."},
      {.section = "source",
       .key = "split",
       .target = &c.source.split,
       .text = "Folder inside the data set that holds the scenes.",
       .accepts = is_file_name,
       .accepted_form = "the name of a folder"},
      {.section = "source",
       .key = "scene",
       .target = &c.source.scene,
       .text = "Play only this scene; -1 plays all.",
       .lowest = -1,
       .highest = 999999},
      {.section = "source",
       .key = "image",
       .target = &c.source.image,
       .text = "Play only the image of this number; -1 plays all.",
       .lowest = -1,
       .highest = 999999},
      {.section = "source",
       .key = "rate_hz",
       .target = &c.source.rate_hz,
       .text =
           "Frames per second. 0 plays as fast as detection takes them and then skips none; a paced source "
           "drops its oldest waiting frame when detection is late, as a camera would.",
       .unit = "Hz",
       .lowest = 0,
       .highest = 1000},
      {.section = "source",
       .key = "loop",
       .target = &c.source.loop,
       .text = "Begin again after the last frame. Without it the daemon ends there."},
      {.section = "source",
       .key = "frame_id",
       .target = &c.source.frame_id,
       .text = "Name of the camera's optical frame (x right, y down, z forward) in the published messages.",
       .accepts = is_frame_id,
       .accepted_form = "1 to 200 letters, digits, _ / - ."},
      {.section = "models",
       .key = "files",
       .target = &c.models.files,
       .text = "Compiled models (made by `sextant compile`), a list. *, ? and [] are expanded; relative "
               "paths start "
               "at this file's folder.",
       .reloads = true},
      {.section = "detect",
       .key = "table",
       .target = &c.detect.table,
       .text =
           "Where the table is known from. frame: the source says so; estimate: fitted to each depth image; "
           "fixed: the three keys below; none: objects may float and lean (slow).",
       .choices = {"none", "frame", "estimate", "fixed"},
       .reloads = true},
      {.section = "detect",
       .key = "table_pitch_deg",
       .target = &c.detect.table_pitch_deg,
       .text = "For table: fixed. How far the camera looks down.",
       .unit = "degrees",
       .lowest = -90,
       .highest = 90,
       .reloads = true},
      {.section = "detect",
       .key = "table_roll_deg",
       .target = &c.detect.table_roll_deg,
       .text = "For table: fixed. Roll of the camera around its optical axis.",
       .unit = "degrees",
       .lowest = -180,
       .highest = 180,
       .reloads = true},
      {.section = "detect",
       .key = "table_height_m",
       .target = &c.detect.table_height_m,
       .text = "For table: fixed. Height of the camera above the table.",
       .unit = "m",
       .lowest = 0.01,
       .highest = 20,
       .reloads = true},
      {.section = "detect",
       .key = "height_tolerance_m",
       .target = &c.detect.height_tolerance_m,
       .text = "How far the centre of an object may be above or below where the table puts it.",
       .unit = "m",
       .lowest = 0.0005,
       .highest = 1,
       .reloads = true},
      {.section = "detect",
       .key = "angle_tolerance_deg",
       .target = &c.detect.angle_tolerance_deg,
       .text = "How far an object may lean.",
       .unit = "degrees",
       .lowest = 0.1,
       .highest = 90,
       .reloads = true},
      {.section = "detect",
       .key = "max_detections",
       .target = &c.detect.max_detections,
       .text = "Most poses of each object in one frame.",
       .lowest = 1,
       .highest = 100,
       .reloads = true},
      {.section = "detect",
       .key = "candidates",
       .target = &c.detect.candidates,
       .text =
           "Most places that are searched and refined for each object: while what is found is more likely "
           "wrong than right, the next best place is looked at, within the deadline; the most certain "
           "max_detections are published. 1: only the best.",
       .lowest = 1,
       .highest = 100,
       .reloads = true},
      {.section = "detect",
       .key = "threshold",
       .target = &c.detect.threshold,
       .text = "Log score that a pose must reach; auto: what the detector takes for each model.",
       .lowest = -1e9,
       .highest = 1e9,
       .reloads = true},
      {.section = "detect",
       .key = "refine",
       .target = &c.detect.refine,
       .text = "Poses between the search's grid points, with a covariance and a probability of being right."},
      {.section = "detect",
       .key = "false_positive_rate",
       .target = &c.detect.false_positive_rate,
       .text = "Wanted share of frames with a false detection, for models that sextant calibrate has seen; 1 "
               "reports all.",
       .lowest = 0.0001,
       .highest = 1},
      {.section = "detect",
       .key = "deadline_ms",
       .target = &c.detect.deadline_ms,
       .text = "The search of one frame ends after this time with the best pose so far and a bound on what "
               "it may "
               "have missed (status bounded). 0 searches until the best pose is proven.",
       .unit = "ms",
       .lowest = 0,
       .highest = 600000,
       .reloads = true},
      {.section = "detect",
       .key = "threads",
       .target = &c.detect.threads,
       .text = "Threads of the search; 0 uses all cores. The result does not depend on it.",
       .lowest = 0,
       .highest = 256,
       .reloads = true},
      {.section = "detect",
       .key = "scoring",
       .target = &c.detect.scoring,
       .text = "How poses are scored: likelihood compares with the background, thesis is the reference.",
       .choices = {"likelihood", "thesis"},
       .reloads = true},
      {.section = "detect",
       .key = "bound",
       .target = &c.detect.bound,
       .text = "The engine of the search: lanes is the fast one, window its plain twin. Both give the same "
               "answers.",
       .choices = {"lanes", "window"},
       .reloads = true},
      {.section = "detect",
       .key = "search_width",
       .target = &c.detect.search_width,
       .text =
           "Width of the image that is searched (0 or at least 64); frames are scaled down to it. 0 searches "
           "the frame as it is.",
       .unit = "pixels",
       .lowest = 0,
       .highest = 4096,
       .reloads = true},
      {.section = "detect",
       .key = "min_distance_m",
       .target = &c.detect.min_distance_m,
       .text = "Nearest distance of an object's centre from the camera.",
       .unit = "m",
       .lowest = 0.06,
       .highest = 60,
       .reloads = true},
      {.section = "detect",
       .key = "max_distance_m",
       .target = &c.detect.max_distance_m,
       .text = "Farthest distance.",
       .unit = "m",
       .lowest = 0.06,
       .highest = 60,
       .reloads = true},
      {.section = "detect",
       .key = "region",
       .target = &c.detect.region,
       .text =
           "Part of the image in which centres of objects are looked for: \"X Y WIDTH HEIGHT\"; empty: all "
           "of it. `sextant ask region` overrides it.",
       .unit = "pixels",
       .reloads = true},
      {.section = "detect",
       .key = "workspace",
       .target = &c.detect.workspace,
       .text =
           "Box in which centres of objects are looked for: \"X0 X1 Y0 Y1 Z0 Z1\"; empty: everywhere. In "
           "the robot's frame where camera_pose is given, else in the table's: origin below the camera, z "
           "up, x where the camera looks.",
       .unit = "m",
       .reloads = true},
      {.section = "detect",
       .key = "camera_pose",
       .target = &c.detect.camera_pose,
       .text = "The camera's optical frame in the robot's, for the workspace: \"X Y Z QX QY QZ QW\".",
       .unit = "m",
       .reloads = true},
      {.section = "detect",
       .key = "runner_up",
       .target = &c.detect.runner_up,
       .text = "Prove how much worse the best other explanation of the image is (runner_up_margin).",
       .reloads = true},
      {.section = "detect",
       .key = "runner_up_radius_m",
       .target = &c.detect.runner_up_radius_m,
       .text = "Another explanation is farther from the pose than this,",
       .unit = "m",
       .lowest = 0,
       .highest = 10,
       .reloads = true},
      {.section = "detect",
       .key = "runner_up_angle_deg",
       .target = &c.detect.runner_up_angle_deg,
       .text = "or turned by more than this, up to the object's symmetry.",
       .unit = "degrees",
       .lowest = 0,
       .highest = 180,
       .reloads = true},
      {.section = "detect",
       .key = "runner_up_most",
       .target = &c.detect.runner_up_most,
       .text = "A larger margin is only proven to be at least this, which is faster; auto: all margins are "
               "proven exactly, down to the threshold.",
       .lowest = 0.001,
       .highest = 1e9,
       .reloads = true},
      {.section = "publish",
       .key = "domain",
       .target = &c.publish.domain,
       .text = "DDS domain. -1 takes the environment's ROS_DOMAIN_ID, and 0 where that is not set.",
       .lowest = -1,
       .highest = 230},
      {.section = "publish",
       .key = "namespace",
       .target = &c.publish.name_space,
       .text =
           "Put before every topic: \"arm\" publishes rt/arm/detections, which ROS 2 calls /arm/detections.",
       .accepts = is_name_or_empty,
       .accepted_form = kNameForm},
      {.section = "publish",
       .key = "detections",
       .target = &c.publish.detections,
       .text = "Topic of vision_msgs/Detection3DArray, one message per frame; \"\" switches it off.",
       .accepts = is_topic_or_empty,
       .accepted_form = kTopicForm},
      {.section = "publish",
       .key = "object_pose",
       .target = &c.publish.object_pose,
       .text = "Topic of geometry_msgs/PoseStamped, the best pose, silent when there is none; \"\" switches "
               "it off.",
       .accepts = is_topic_or_empty,
       .accepted_form = kTopicForm},
      {.section = "publish",
       .key = "pose_estimates",
       .target = &c.publish.pose_estimates,
       .text = "Topic of sextant_msgs/PoseEstimateArray, all poses with their certificates; \"\" switches it "
               "off.",
       .accepts = is_topic_or_empty,
       .accepted_form = kTopicForm},
      {.section = "publish",
       .key = "tf",
       .target = &c.publish.tf,
       .text = "Topic of tf2_msgs/TFMessage: every pose as a frame below the camera's; \"/tf\" is where ROS "
               "2 looks for it whatever the namespace; \"\" switches it off.",
       .accepts = is_topic_or_empty,
       .accepted_form = kTopicForm},
      {.section = "publish",
       .key = "tf_prefix",
       .target = &c.publish.tf_prefix,
       .text = "Put before the object's name in child_frame_id; second and further poses of an object get "
               "_2, _3, ... "
               "after it.",
       .accepts = is_frame_prefix,
       .accepted_form = "up to 200 letters, digits, _ / - ."},
      {.section = "publish",
       .key = "markers",
       .target = &c.publish.markers,
       .text = "Topic of visualization_msgs/MarkerArray for RViz and Foxglove, made only while someone "
               "listens; \"\" switches it off.",
       .accepts = is_topic_or_empty,
       .accepted_form = kTopicForm},
      {.section = "publish",
       .key = "marker_shape",
       .target = &c.publish.marker_shape,
       .text = "How markers show objects: their meshes, or the boxes around them (smaller messages).",
       .choices = {"mesh", "box"}},
      {.section = "publish",
       .key = "annotated",
       .target = &c.publish.annotated,
       .text = "Topic of sensor_msgs/Image: the colour image with the poses drawn into it, made only while "
               "someone listens; \"\" switches it off.",
       .accepts = is_topic_or_empty,
       .accepted_form = kTopicForm},
      {.section = "publish",
       .key = "table_estimate",
       .target = &c.publish.table_estimate,
       .text = "Topic of sextant_msgs/TableEstimate: where the table is, for every frame that has one; \"\" "
               "switches it off.",
       .accepts = is_topic_or_empty,
       .accepted_form = kTopicForm},
      {.section = "publish",
       .key = "diagnostics",
       .target = &c.publish.diagnostics,
       .text = "Topic of diagnostic_msgs/DiagnosticArray: rates, latencies by stage, drops, search status, "
               "temperatures; \"\" switches it off.",
       .accepts = is_topic_or_empty,
       .accepted_form = kTopicForm},
      {.section = "publish",
       .key = "diagnostics_period_ms",
       .target = &c.publish.diagnostics_period_ms,
       .text = "Time between two reports on the diagnostics topic.",
       .unit = "ms",
       .lowest = 100,
       .highest = 60000},
      {.section = "publish",
       .key = "lease_ms",
       .target = &c.publish.lease_ms,
       .text = "Readers learn after this time that the daemon was killed, or (detections) that frames fail "
               "to come. "
               "Readers that ask for less get nothing.",
       .unit = "ms",
       .lowest = 50,
       .highest = 60000},
      {.section = "publish",
       .key = "once_wait_ms",
       .target = &c.publish.once_wait_ms,
       .text = "With --once: how long to wait for a reader before the frame and for its acknowledgement "
               "after it.",
       .unit = "ms",
       .lowest = 0,
       .highest = 600000},
      {.section = "commands",
       .key = "command",
       .target = &c.commands.command,
       .text = "Topic of sextant_msgs/Command, in the namespace of publish; \"\" switches commands off.",
       .accepts = is_topic_or_empty,
       .accepted_form = kTopicForm},
      {.section = "commands",
       .key = "answer",
       .target = &c.commands.answer,
       .text = "Topic of sextant_msgs/CommandAnswer.",
       .accepts = is_topic_path,
       .accepted_form = kTopicForm},
      {.section = "commands",
       .key = "look_patience_ms",
       .target = &c.commands.look_patience_ms,
       .text = "A look that no frame came for is answered after this time.",
       .unit = "ms",
       .lowest = 100,
       .highest = 600000},
      {.section = "pipeline",
       .key = "queue_frames",
       .target = &c.pipeline.queue_frames,
       .text =
           "Frames that may wait for detection. When another one comes, the oldest is dropped and counted.",
       .lowest = 1,
       .highest = 100},
      {.section = "pipeline",
       .key = "max_age_ms",
       .target = &c.pipeline.max_age_ms,
       .text = "A result that is older than this, from capture, is dropped and counted, never published as "
               "fresh. "
               "Also the lifespan of pose_estimates.",
       .unit = "ms",
       .lowest = 10,
       .highest = 3600000},
      {.section = "pipeline",
       .key = "max_frame_age_ms",
       .target = &c.pipeline.max_frame_age_ms,
       .text =
           "A frame that is older than this, from capture, when its search could begin is not searched but "
           "counted as stale. auto: 100 for cameras, none for playback.",
       .unit = "ms",
       .lowest = 1,
       .highest = 3600000},
      {.section = "log",
       .key = "level",
       .target = &c.log.level,
       .text = "Least severe lines that are written.",
       .choices = {"debug", "info", "warn", "error"},
       .reloads = true},
  };
  for (ConfigField& field : live_fields(c.live)) fields.push_back(std::move(field));
  for (ConfigField& field : table_fields(c.table)) fields.push_back(std::move(field));
  return fields;
}

}  // namespace sextant
