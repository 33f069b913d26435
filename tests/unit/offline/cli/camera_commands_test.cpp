// SPDX-License-Identifier: Apache-2.0
// `sextant record`, `camera` and `doctor` as a user calls them, on the bundled sample.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <unistd.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <random>

#include "hal/image/image_file.h"
#include "hal/playback/bop_dataset.h"
#include "offline/cli/camera_measurement.h"
#include "offline/cli/commands.h"
#include "offline/cli/machine_checks.h"
#include "runtime/base/error.h"
#include "tests/support/temporary_folder.h"

namespace sextant {
namespace {

const std::string kSample = SEXTANT_SOURCE_DIR "/data/sample";

struct Outcome {
  int exit_code = -1;
  std::string output;
  nlohmann::json json() const { return nlohmann::json::parse(output); }
};

Outcome call(const std::string& command_line) {
  CLI::App app("test", "sextant");
  Outcome outcome;
  add_record_command(app, outcome.exit_code);
  add_camera_command(app, outcome.exit_code);
  add_doctor_command(app, outcome.exit_code);
  testing::internal::CaptureStdout();
  try {
    app.parse(command_line);
  } catch (...) {
    testing::internal::GetCapturedStdout();
    throw;
  }
  outcome.output = testing::internal::GetCapturedStdout();
  return outcome;
}

TEST(RecordCommand, RecordsWhatItIsGivenAndSaysSo) {
  const TemporaryFolder folder;
  const Outcome outcome = call("record -o " + folder.path().string() + " --dataset " + kSample + " --json");
  EXPECT_EQ(outcome.exit_code, 0);
  const nlohmann::json json = outcome.json();
  EXPECT_EQ(json["recorded"], 4);
  EXPECT_EQ(json["lost_slow"], 0);
  EXPECT_EQ(json["lost_source_reasons"], "none");
  const BopDataset before = open_bop_dataset(kSample, "test");
  const BopDataset after = open_bop_dataset(folder.path(), "test");
  ASSERT_EQ(after.images.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    const RgbdFrame a = load_frame(before.images[i]);
    const RgbdFrame b = load_frame(after.images[i]);
    EXPECT_EQ(cv::norm(a.colour, b.colour, cv::NORM_INF), 0);
    EXPECT_LT(cv::norm(a.axial_depth_m, b.axial_depth_m, cv::NORM_INF), 1e-4);
    EXPECT_EQ(a.camera.fx, b.camera.fx);
    ASSERT_TRUE(b.table);
    EXPECT_NEAR(a.table->camera_height_m, b.table->camera_height_m, 1e-12);
  }
  // Its own recordings play, with an estimated table, as a second scene.
  const Outcome again = call("record -o " + folder.path().string() + " --dataset " + folder.path().string() +
                             " --scene 1 --frames 2 --table estimate --json");
  EXPECT_EQ(again.json()["recorded"], 2);
  EXPECT_EQ(open_bop_dataset(folder.path(), "test", 2).images.size(), 2U);
}

TEST(RecordCommand, SaysWhatIsWrong) {
  const TemporaryFolder folder;
  const std::string to = "record -o " + folder.path().string();
  EXPECT_THROW(call(to), UsageError);
  EXPECT_THROW(call(to + " --dataset /nowhere"), InputError);
  EXPECT_THROW(call(to + " --source telepathy"), UsageError);
  EXPECT_THROW(call(to + " --source v4l2 --color-device a --depth-device b"), UsageError);  // no rig
  EXPECT_THROW(call(to + " --source dds --color-topic /a --depth-topic b"), UsageError);
  EXPECT_THROW(call(to + " --dataset " + kSample + " --by-timestamps"), UsageError);
  EXPECT_THROW(call(to + " --dataset " + kSample + " --table guess"), UsageError);
}

TEST(CameraCommand, ChecksTheSampleAndDrawsIt) {
  const TemporaryFolder folder;
  const std::string picture = (folder.path() / "p.png").string();
  const Outcome outcome = call("camera check --dataset " + kSample + " --json --picture " + picture);
  EXPECT_EQ(outcome.exit_code, 0);
  const nlohmann::json json = outcome.json();
  EXPECT_EQ(json["frames"], 4);
  EXPECT_EQ(json["refused"], 0);
  EXPECT_LT(json["height_error_m"]["highest"], 0.01);
  EXPECT_LT(json["tilt_error_rad"]["highest"], 0.02);
  EXPECT_TRUE(json["interval_ms"].is_null());  // as fast as possible: no rate
  const cv::Mat drawn = read_colour_image(picture);
  EXPECT_EQ(drawn.cols, 2 * 640);
  // The grid is there: pixels of its green that the frame does not have.
  int green = 0;
  for (int y = 0; y < 480; ++y) {
    for (int x = 0; x < 640; ++x) {
      const cv::Vec3b& p = drawn.at<cv::Vec3b>(y, x);
      green += p[1] > 200 && p[0] < 120 && p[2] < 160 ? 1 : 0;
    }
  }
  EXPECT_GT(green, 500);
}

TEST(CameraCommand, ShowNeedsAPlaceAndACamera) {
  EXPECT_THROW(call("camera show --dataset " + kSample), CLI::RequiredError);
  const TemporaryFolder folder;
  const std::string picture = (folder.path() / "p.png").string();
  EXPECT_EQ(call("camera show --dataset " + kSample + " -o " + picture).exit_code, 0);
  EXPECT_TRUE(std::filesystem::exists(picture));
}

TEST(CameraCommand, ListIsJson) {
  const Outcome outcome = call("camera list --no-dds --json");
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_TRUE(outcome.json()["devices"].is_array());
}

RgbdFrame table_frame(int ms, double noise_m, unsigned seed) {
  RgbdFrame f;
  f.camera = {.width = 320, .height = 240, .fx = 280, .fy = 280, .cx = 159.5, .cy = 119.5};
  f.colour = cv::Mat::zeros(240, 320, CV_8UC3);
  f.axial_depth_m = cv::Mat::zeros(240, 320, CV_32FC1);
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, noise_m);
  const TableGeometry table = TableGeometry::from_pitch_roll(0.9, 0, 0.6);
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 320; ++x) {
      const double down = -table.up_in_camera.dot(Eigen::Vector3d((x - 159.5) / 280, (y - 119.5) / 280, 1));
      if (random() % 10 == 0) continue;
      f.axial_depth_m.at<float>(y, x) = static_cast<float>(0.6 / down + noise(random));
    }
  }
  f.captured_monotonic = MonotonicTime(std::chrono::hours(1) + std::chrono::milliseconds(ms));
  return f;
}

const Finding& named(const std::vector<Finding>& findings, const std::string& check) {
  for (const Finding& f : findings) {
    if (f.check == check) return f;
  }
  throw std::runtime_error("no finding about " + check);
}

TEST(CameraMeasurement, MeasuresRateAgeNoiseAndHoles) {
  CameraMeasurement m(true);
  for (int i = 0; i < 20; ++i) {
    const RgbdFrame f = table_frame(i * 33 + (i % 2) * 4, 0.002, static_cast<unsigned>(i));
    m.add(f, f.captured_monotonic + std::chrono::milliseconds(12));
  }
  SourceStatistics source;
  source.delivered = 20;
  const nlohmann::ordered_json json = m.json(source);
  EXPECT_NEAR(json["interval_ms"]["median"], 33, 4.1);
  EXPECT_NEAR(json["age_ms"]["median"], 12, 1e-6);
  EXPECT_NEAR(json["depth_noise_m"], 0.002, 0.0004);
  EXPECT_NEAR(json["depth_missing_share"]["median"], 0.1, 0.02);
  EXPECT_NEAR(json["table_missing_share"]["median"], 0.1, 0.03);
  EXPECT_NEAR(json["height_m"]["median"], 0.6, 0.002);
  EXPECT_EQ(named(m.findings(source), "age").state, FindingState::kGood);
  EXPECT_EQ(named(m.findings(source), "table holes").state, FindingState::kWarning);
  EXPECT_FALSE(named(m.findings(source), "table holes").advice.empty());
  source.drop(DropReason::kUnpaired) = 10;
  EXPECT_EQ(named(m.findings(source), "losses").state, FindingState::kWarning);
}

TEST(CameraMeasurement, BadIsBad) {
  CameraMeasurement m(true);
  RgbdFrame f = table_frame(0, 0.002, 1);
  f.axial_depth_m.setTo(0);
  m.add(f, f.captured_monotonic + std::chrono::milliseconds(300));
  EXPECT_EQ(named(m.findings({}), "table").state, FindingState::kBad);
  EXPECT_TRUE(any_bad(CameraMeasurement(true).findings({})));
}

class Machine : public testing::Test {
 protected:
  void show(const std::string& file, const std::string& text) const {
    const std::filesystem::path path = folder_.path() / file;
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path) << text;
  }
  TemporaryFolder folder_;
  MachinePlaces places_{folder_.path()};
};

TEST_F(Machine, SocketBuffers) {
  show("proc/sys/net/core/rmem_max", "212992\n");
  EXPECT_EQ(check_socket_buffers(places_)[0].state, FindingState::kWarning);
  EXPECT_THAT(check_socket_buffers(places_)[0].advice, testing::HasSubstr("sysctl -w net.core.rmem_max"));
  show("proc/sys/net/core/rmem_max", "8388608\n");
  EXPECT_EQ(check_socket_buffers(places_)[0].state, FindingState::kGood);
}

TEST_F(Machine, Memory) {
  show("proc/meminfo", "MemTotal: 8000000 kB\nMemAvailable:    300000 kB\n");
  EXPECT_EQ(check_memory(places_)[0].state, FindingState::kBad);
  show("proc/meminfo", "MemAvailable:    6000000 kB\n");
  EXPECT_EQ(check_memory(places_)[0].state, FindingState::kGood);
}

TEST_F(Machine, Processor) {
  show("proc/cpuinfo", "processor : 0\nflags\t\t: fpu sse4_2 avx2\n");
  EXPECT_THAT(check_processor(places_)[0].what, testing::HasSubstr("avx2"));
  show("proc/cpuinfo", "Features\t: fp asimd\n");
  EXPECT_THAT(check_processor(places_)[0].what, testing::HasSubstr("neon"));
  show("proc/cpuinfo", "flags : fpu\n");
  show("sys/devices/system/cpu/cpu0/cpufreq/scaling_governor", "powersave\n");
  const auto findings = check_processor(places_);
  ASSERT_EQ(findings.size(), 2U);
  EXPECT_EQ(findings[0].state, FindingState::kWarning);
  EXPECT_EQ(findings[1].state, FindingState::kWarning);
}

TEST_F(Machine, CameraNodes) {
  EXPECT_EQ(check_camera_permissions(places_)[0].state, FindingState::kNote);
  show("dev/video0", "");
  show("dev/videofoo", "");
  EXPECT_EQ(check_camera_permissions(places_)[0].state, FindingState::kGood);
  if (geteuid() == 0) GTEST_SKIP() << "root may open everything";
  std::filesystem::permissions(folder_.path() / "dev/video0", std::filesystem::perms::none);
  EXPECT_EQ(check_camera_permissions(places_)[0].state, FindingState::kBad);
}

TEST(Doctor, ModelsAreRead) {
  const auto findings = check_models({"/nowhere.sxm"});
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].state, FindingState::kBad);
}

TEST(Doctor, DdsLoopbackCarriesImages) {
  ASSERT_EQ(setenv("CYCLONEDDS_URI", "file://" SEXTANT_SOURCE_DIR "/config/cyclonedds.xml", 1), 0);
  const auto findings = check_dds(static_cast<unsigned>(1 + getpid() % 200));
  EXPECT_THAT(findings.back().what, testing::HasSubstr("of 30 images"));
  EXPECT_NE(findings.back().state, FindingState::kBad) << findings.back().what;
}

TEST(Doctor, JsonListsTheFindings) {
  const Outcome outcome = call("doctor --no-dds --json");
  const nlohmann::json json = outcome.json();
  ASSERT_GE(json["findings"].size(), 5U);
  for (const auto& finding : json["findings"]) {
    EXPECT_TRUE(finding["state"] == "good" || !finding["what"].get<std::string>().empty());
  }
}

}  // namespace
}  // namespace sextant
