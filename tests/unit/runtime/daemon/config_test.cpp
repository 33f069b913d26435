// SPDX-License-Identifier: Apache-2.0
// The configuration file: the shipped one, good values, and every way to get it wrong.
#include <gmock/gmock.h>

#include <fstream>
#include <sstream>

#include "runtime/base/error.h"
#include "runtime/daemon/config_reader.h"
#include "runtime/daemon/config_reference.h"
#include "runtime/daemon/nearest_name.h"
#include "tests/support/temporary_folder.h"

namespace sextant {
namespace {

using testing::HasSubstr;

constexpr char kShipped[] = SEXTANT_SOURCE_DIR "/config/sextantd.yaml";
/// The least that is complete.
constexpr char kMinimal[] = "source: {dataset: d}\nmodels: {files: [m.sxm]}\n";

std::string contents(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::stringstream text;
  text << stream.rdbuf();
  return text.str();
}

DaemonConfig parse(const std::string& text) { return parse_config(text, "file.yaml", "/folder"); }

/// The message of the InputError that the text must cause.
std::string error_of(const std::string& text) {
  try {
    parse(text);
  } catch (const InputError& error) {
    EXPECT_EQ(error.exit_code(), ExitCode::kBadInput);
    return error.what();
  }
  ADD_FAILURE() << "accepted: " << text.substr(0, 200);
  return "";
}

TEST(ShippedConfig, IsExactlyTheReferenceOfItsOwnValues) {
  // So every key is there with its text, unit, range and default, and nothing else is.
  EXPECT_EQ(config_reference(read_config(kShipped)), contents(kShipped));
}

TEST(ShippedConfig, PlaysTheBundledSampleInALoop) {
  const DaemonConfig config = read_config(kShipped);
  EXPECT_EQ(source_options(config).playback.dataset,
            std::filesystem::path(SEXTANT_SOURCE_DIR) / "data/sample");
  EXPECT_TRUE(source_options(config).playback.loop);
  EXPECT_EQ(config.models.files, std::vector<std::string>{"../build/models/*.sxm"});
}

TEST(ConfigReference, DocumentsEveryKeyAndReadsBack) {
  DaemonConfig config = parse(kMinimal);
  config.source.dataset = "a \"b\" \\ \xc3\xa4: #c";
  config.detect.threshold = -12.25;
  config.models.files = {"x", "y, z"};
  const std::string text = config_reference(config);
  for (const ConfigField& field : config_fields(config)) {
    EXPECT_THAT(text, HasSubstr("\n  " + field.key + ": ")) << field.section;
    EXPECT_FALSE(field.text.empty());
  }
  const DaemonConfig back = parse(text);
  EXPECT_EQ(back.source.dataset, config.source.dataset);
  EXPECT_EQ(back.detect.threshold, config.detect.threshold);
  EXPECT_EQ(back.models.files, config.models.files);
  EXPECT_EQ(config_reference(back), text);
}

TEST(Config, DefaultsAreThoseOfTheParts) {
  const DaemonConfig config = parse(kMinimal);
  const DetectOptions detect = detect_options(config);
  EXPECT_EQ(detect.table, DetectOptions().table);
  EXPECT_NEAR(detect.tolerance.angle_rad, DetectOptions().tolerance.angle_rad, 1e-12);
  EXPECT_EQ(detect.scoring, DetectOptions().scoring);
  EXPECT_EQ(detect.threshold, std::nullopt);
  EXPECT_EQ(publisher_options(config).detections_topic, "detections");
  EXPECT_EQ(publisher_options(config).max_age_ms, pipeline_options(config).max_age_ms);
  EXPECT_TRUE(pipeline_options(config).skip_none);
}

TEST(Config, ValuesReachTheParts) {
  const DaemonConfig config = parse(
      "source: {dataset: ../data, split: train, scene: 3, image: 7, rate_hz: 12.5, loop: true, frame_id: "
      "cam/optical}\n"
      "models: {files: [a.sxm, /b/c.sxm]}\n"
      "detect: {table: fixed, table_pitch_deg: 45, table_roll_deg: -10, table_height_m: 0.75, "
      "angle_tolerance_deg: 90,\n"
      "  max_detections: 4, threshold: -3, deadline_ms: 100, threads: 2, scoring: thesis, search_width: "
      "320}\n"
      "publish: {domain: 17, namespace: arm, object_pose: \"\", lease_ms: 250, tf: /tf, tf_prefix: seen_,\n"
      "  marker_shape: box, annotated: \"\"}\n"
      "commands: {command: \"\"}\n"
      "pipeline: {queue_frames: 5, max_age_ms: 2000}\n");
  const PlaybackOptions source = source_options(config).playback;
  EXPECT_EQ(source.dataset, "/data");
  EXPECT_EQ(source.split, "train");
  EXPECT_EQ(source.scene, 3);
  EXPECT_EQ(source.image, 7);
  EXPECT_EQ(source.rate_hz, 12.5);
  EXPECT_EQ(source.frame_id, "cam/optical");
  const DetectOptions detect = detect_options(config);
  EXPECT_EQ(detect.table, TableSource::kFixed);
  EXPECT_NEAR(detect.fixed_table.pitch_rad(), M_PI / 4, 1e-12);
  EXPECT_NEAR(detect.fixed_table.roll_rad(), -M_PI / 18, 1e-12);
  EXPECT_NEAR(detect.tolerance.angle_rad, M_PI / 2, 1e-12);
  EXPECT_EQ(detect.max_detections, 4);
  EXPECT_EQ(detect.threshold, -3);
  EXPECT_EQ(detect.scoring, "thesis");
  const PublisherOptions publish = publisher_options(config);
  EXPECT_EQ(publish.domain, 17U);
  EXPECT_EQ(publish.name_space, "arm");
  EXPECT_EQ(publish.object_pose_topic, "");
  EXPECT_EQ(publish.lease_ms, 250);
  EXPECT_EQ(publish.tf_topic, "/tf");
  EXPECT_EQ(publish.tf_prefix, "seen_");
  EXPECT_FALSE(publish.marker_mesh);
  EXPECT_EQ(publish.annotated_topic, "");
  EXPECT_EQ(publish.table_topic, "table_estimate");
  EXPECT_EQ(command_options(config).command_topic, "");
  EXPECT_EQ(command_options(config).name_space, "arm");
  EXPECT_EQ(publish.max_age_ms, 2000);
  EXPECT_FALSE(pipeline_options(config).skip_none);
  EXPECT_EQ(pipeline_options(config).queue_frames, 5);
}

TEST(Config, TheDomainMayComeFromTheEnvironment) {
  const DaemonConfig config = parse(kMinimal);
  setenv("ROS_DOMAIN_ID", "42", 1);
  EXPECT_EQ(publisher_options(config).domain, 42U);
  for (const char* bad : {"231", "-1", "4x", "99999999999"}) {
    setenv("ROS_DOMAIN_ID", bad, 1);
    EXPECT_THROW(publisher_options(config), UsageError) << bad;
  }
  unsetenv("ROS_DOMAIN_ID");
  EXPECT_EQ(publisher_options(config).domain, 0U);
}

TEST(Config, ErrorsNameFileLineAndWhatToWrite) {
  const std::string base = kMinimal;  // two lines: what is added stands on line 3 or later
  EXPECT_THAT(error_of(base + "detect:\n  thread: 4\n"),
              testing::AllOf(HasSubstr("file.yaml:4:"), HasSubstr("unknown key of detect 'thread'"),
                             HasSubstr("did you mean 'threads'?")));
  EXPECT_THAT(error_of(base + "detetc: {}\n"),
              testing::AllOf(HasSubstr("file.yaml:3:"), HasSubstr("did you mean 'detect'?")));
  EXPECT_THAT(error_of(base + "log: {xyzzy: 1}\n"), HasSubstr("known: level"));
  EXPECT_THAT(error_of(base + "detect:\n  threads: 1\n  threads: 2\n"),
              testing::AllOf(HasSubstr("file.yaml:5:"), HasSubstr("twice")));
  EXPECT_THAT(error_of(base + "log: {}\nlog: {}\n"), testing::AllOf(HasSubstr(":4:"), HasSubstr("twice")));
  EXPECT_THAT(error_of(base + "detect:\n\n  deadline_ms: -1\n"),
              testing::AllOf(HasSubstr(":5:"), HasSubstr("detect.deadline_ms is '-1'"),
                             HasSubstr("a number from 0 to 600000 ms")));
  for (const char* bad :
       {"1.5", "two", "\"\"", "~", "[1]", "{a: 1}", "99999999999999999999", "257", "0x10", "1 2"}) {
    EXPECT_THAT(error_of(base + "detect: {threads: " + bad + "}\n"), HasSubstr("whole number from 0 to 256"))
        << bad;
  }
  for (const char* bad : {".nan", "nan", "inf", "-inf", "1e999", "fast"}) {
    EXPECT_THAT(error_of(base + "detect: {min_distance_m: " + bad + "}\n"), HasSubstr("write a number from"))
        << bad;
  }
  for (const char* bad : {"yes", "1", "True", "[]"}) {
    EXPECT_THAT(error_of("source: {dataset: d, loop: " + std::string(bad) + "}\n"),
                HasSubstr("true or false"));
  }
  EXPECT_THAT(error_of(base + "detect: {table: chair}\n"), HasSubstr("one of none, frame, estimate, fixed"));
  EXPECT_THAT(error_of(base + "detect: {threshold: high}\n"), HasSubstr("or auto"));
  EXPECT_THAT(error_of(base + "publish: {detections: //detections}\n"), HasSubstr("a topic name"));
  EXPECT_THAT(error_of("source: {dataset: d, split: ../x}\n"), HasSubstr("the name of a folder"));
  EXPECT_THAT(error_of("source: {dataset: d, frame_id: \"a\\nb\"}\n"), HasSubstr("source.frame_id is 'a?b'"));
  EXPECT_THAT(error_of("models: {files: m.sxm}\n"), HasSubstr("a list"));
  EXPECT_THAT(error_of("models: {files: [\"\"]}\n"), HasSubstr("no empty text"));
  EXPECT_THAT(error_of("[1, 2]\n"), HasSubstr("begin with `source:`"));
  EXPECT_THAT(error_of("source: 5\n"), HasSubstr("is no map"));
  EXPECT_THAT(error_of("[a]: 5\n"), HasSubstr("is no text"));
}

TEST(Config, ChecksWhatNoKeyKnowsAlone) {
  EXPECT_THAT(error_of(""), HasSubstr("source.dataset is missing"));
  EXPECT_THAT(error_of("source:\nmodels:\n"), HasSubstr("source.dataset is missing"));
  EXPECT_THAT(error_of("source: {dataset: d}\n"), HasSubstr("models.files is empty"));
  const std::string base = kMinimal;
  EXPECT_THAT(error_of(base + "detect: {min_distance_m: 2, max_distance_m: 2}\n"),
              HasSubstr("min_distance_m"));
  EXPECT_THAT(error_of(base + "detect: {search_width: 63}\n"), HasSubstr("search_width"));
  EXPECT_THAT(error_of(base + "publish: {detections: a, object_pose: a}\n"), HasSubstr("same name"));
  EXPECT_THAT(error_of(base + "publish: {namespace: " + std::string(195, 'a') + "}\n"),
              HasSubstr("too long"));
  EXPECT_THAT(error_of(base + "publish: {namespace: arm, tf: /arm/markers}\n"),
              HasSubstr("same name: arm/markers"));
  EXPECT_THAT(error_of(base + "commands: {answer: \"\"}\n"), HasSubstr("a topic name"));
  EXPECT_NO_THROW(parse(base + "publish: {detections: \"\", object_pose: \"\", pose_estimates: \"\"}\n"));
}

TEST(Config, FoldersOfModelsAreThoseOfThePatterns) {
  DaemonConfig config;
  config.folder = "/etc/sextant";
  config.models.files = {"models/*.sxm", "models/mug.sxm", "/opt/more/can.sxm"};
  EXPECT_THAT(model_folders(config), testing::ElementsAre(std::filesystem::path("/etc/sextant/models"),
                                                          std::filesystem::path("/opt/more")));
}

constexpr char kCameras[] =
    "source: {kind: v4l2}\nmodels: {files: [m.sxm]}\ndetect: {table: estimate}\n"
    "colour: {device: usb-Maker_Cam-video-index0, format: MJPG, rate_hz: 15, controls: [\"gain=16\"]}\n"
    "depth: {device: \"serial:7\"}\nlive: {rig: rig.yaml, width: 640, max_age_ms: 80, watchdog_ms: 500, "
    "buffers: 6}\n";

TEST(Config, CamerasReachTheirSource) {
  const DaemonConfig config = parse(kCameras);
  const SourceOptions source = source_options(config);
  EXPECT_EQ(source.kind, "v4l2");
  EXPECT_EQ(source.rig, config.folder / "rig.yaml");
  EXPECT_EQ(source.max_age, std::chrono::milliseconds(80));
  EXPECT_EQ(source.width, 640);
  EXPECT_EQ(source.colour.device, "usb-Maker_Cam-video-index0");
  EXPECT_EQ(source.colour.format, "MJPG");
  EXPECT_EQ(source.colour.rate_hz, 15);
  EXPECT_THAT(source.colour.controls, testing::ElementsAre("gain=16"));
  EXPECT_EQ(source.colour.buffers, 6);
  EXPECT_EQ(source.depth.device, "serial:7");
  EXPECT_EQ(source.depth.watchdog, std::chrono::milliseconds(500));
  EXPECT_TRUE(source.depth.wait_for_device);
  const PipelineOptions pipeline = pipeline_options(config);
  EXPECT_FALSE(pipeline.skip_none);
  EXPECT_EQ(pipeline.max_frame_age_ms, 100);
  EXPECT_EQ(pipeline_options(parse(kMinimal)).max_frame_age_ms, 0);
  EXPECT_EQ(config_reference(parse(config_reference(config))), config_reference(config));
}

TEST(Config, CamerasAreCheckedBeforeTheyAreOpened) {
  const auto but = [](const std::string& from, const std::string& to) {
    std::string text = kCameras;
    return error_of(text.replace(text.find(from), from.size(), to));
  };
  EXPECT_THAT(but("serial:7", ""), HasSubstr("depth.device is missing"));
  EXPECT_THAT(but("serial:7", "usb-Maker_Cam-video-index0"), HasSubstr("are the same"));
  EXPECT_THAT(but("MJPG", "Z16"), HasSubstr("colour.format Z16 holds no colour"));
  EXPECT_THAT(but("MJPG", "H264"), HasSubstr("the name of a format"));
  EXPECT_THAT(but("rig: rig.yaml, ", ""), HasSubstr("live.rig is missing"));
  EXPECT_THAT(but("width: 640", "width: 30"), HasSubstr("live.width is below 64"));
  EXPECT_THAT(but("width: 640", "width: 5000"), HasSubstr("live.width"));
  EXPECT_THAT(but("table: estimate", "table: frame"), HasSubstr("does not say where the table is"));
  EXPECT_THAT(but("kind: v4l2", "kind: dds"), HasSubstr("colour.topic is missing"));
  EXPECT_THAT(but("kind: v4l2", "kind: webcam"), HasSubstr("one of playback, v4l2, libcamera, dds"));
}

TEST(Config, ModelPatternsAreExpandedOnceEach) {
  const TemporaryFolder folder;
  for (const char* name : {"b.sxm", "a.sxm", "c.txt"}) std::ofstream(folder / name) << "x";
  DaemonConfig config;
  config.folder = folder.path();
  config.models.files = {"*.sxm", "b.sxm"};
  EXPECT_THAT(model_files(config), testing::ElementsAre(folder / "a.sxm", folder / "b.sxm"));
  config.models.files = {"*.none"};
  EXPECT_THROW(model_files(config), InputError);
  config.models.files = {"no_folder/*.sxm"};
  EXPECT_THROW(model_files(config), InputError);
}

TEST(NearestName, IsTheOneWithTheFewestEdits) {
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3);
  EXPECT_EQ(edit_distance("", "abc"), 3);
  EXPECT_EQ(edit_distance("abc", "abc"), 0);
  const std::vector<std::string> known = {"threads", "threshold", "table", "max_age_ms"};
  EXPECT_EQ(nearest_name("tables", known), "table");
  EXPECT_EQ(nearest_name("max_age", known), "max_age_ms");
  EXPECT_EQ(nearest_name("treshold", known), "threshold");
  EXPECT_EQ(nearest_name("zebra", known), "");
  EXPECT_EQ(nearest_name(std::string(100000, 't'), known), "");
}

}  // namespace
}  // namespace sextant
