// SPDX-License-Identifier: Apache-2.0
// Commands change what is looked for from the next frame on; what fails changes nothing.
#include "runtime/daemon/detection_service.h"

#include <gmock/gmock.h>

#include <cmath>
#include <fstream>
#include <opencv2/core.hpp>
#include <thread>

#include "runtime/base/error.h"
#include "runtime/model/model_file.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/runtime/model/synthetic_model.h"

namespace sextant {
namespace {

using testing::HasSubstr;
using namespace std::chrono_literals;

RgbdFrame noise_frame(int width = 96, int height = 72) {
  RgbdFrame frame;
  cv::RNG random(7);
  frame.colour.create(height, width, CV_8UC3);
  random.fill(frame.colour, cv::RNG::UNIFORM, 0, 255);
  frame.axial_depth_m = cv::Mat(height, width, CV_32FC1, cv::Scalar(0.8));
  frame.camera.width = width;
  frame.camera.height = height;
  frame.camera.fx = frame.camera.fy = 90;
  frame.camera.cx = (width - 1) / 2.0;
  frame.camera.cy = (height - 1) / 2.0;
  const CaptureStamp now = read_clocks();
  frame.captured_at = now.realtime;
  frame.captured_monotonic = now.monotonic;
  frame.frame_id = "camera";
  return frame;
}

LoadedModel model(const std::string& name, int id) {
  LoadedModel loaded{test::make_box_model(1, 12, static_cast<std::uint64_t>(id)), "/models/" + name + ".sxm"};
  loaded.model.name = name;
  loaded.model.object_id = id;
  return loaded;
}

DetectionSetup setup_of(std::vector<LoadedModel> models) {
  DetectionSetup setup;
  setup.models = std::move(models);
  setup.options.table = TableSource::kFixed;
  setup.options.fixed_table = TableGeometry::from_pitch_roll(0.7, 0, 0.7);
  setup.options.threads = 1;
  setup.options.threshold = -1e9;  // something is always found
  setup.options.bound = "window";  // quick where every pose counts
  return setup;
}

Command command(CommandKind kind, const std::string& object = "", double value = NAN) {
  Command c;
  c.request_id = "r";
  c.kind = kind;
  c.object_name = object;
  c.value = value;
  return c;
}

std::vector<std::string> names_of(const FrameResult& result) {
  std::vector<std::string> names;
  for (const ObjectOutcome& object : result.objects) names.push_back(object.object_name);
  return names;
}

class Service : public testing::Test {
 protected:
  std::vector<std::string> shapes_;  // names of the last models that were announced
  DetectionService service_{setup_of({model("mug", 1), model("can", 2)}), [this](const auto& models) {
                              shapes_.clear();
                              for (const ObjectModel& m : models) shapes_.push_back(m.name);
                            }};

  CommandAnswer done(const Command& c) {
    CommandAnswer answer = service_.execute(c);
    EXPECT_EQ(answer.result, CommandResult::kDone) << answer.message;
    EXPECT_EQ(answer.request_id, "r");
    return answer;
  }
  CommandAnswer refused(const Command& c) {
    const CommandAnswer before = service_.execute(command(CommandKind::kStatus));
    CommandAnswer answer = service_.execute(c);
    EXPECT_EQ(answer.result, CommandResult::kRefused) << answer.message;
    EXPECT_EQ(answer.objects.size(), before.objects.size());
    EXPECT_EQ(answer.region, before.region);
    EXPECT_EQ(answer.deadline_ms, before.deadline_ms);
    return answer;
  }
};

TEST_F(Service, LooksForWhatIsEnabled) {
  EXPECT_THAT(names_of(service_.detect(noise_frame())), testing::ElementsAre("mug", "can"));
  CommandAnswer answer = done(command(CommandKind::kDisable, "mug"));
  EXPECT_FALSE(answer.objects[0].enabled);
  EXPECT_TRUE(answer.objects[1].enabled);
  EXPECT_THAT(names_of(service_.detect(noise_frame())), testing::ElementsAre("can"));
  done(command(CommandKind::kDisable));
  const RgbdFrame frame = noise_frame();
  const FrameResult nothing = service_.detect(frame);
  EXPECT_TRUE(nothing.objects.empty());
  EXPECT_EQ(nothing.captured_at, frame.captured_at);
  done(command(CommandKind::kEnable));
  EXPECT_THAT(names_of(service_.detect(noise_frame())), testing::ElementsAre("mug", "can"));
}

TEST_F(Service, ThresholdsAreOfOneObjectOrOfAll) {
  done(command(CommandKind::kThreshold, "mug", 1e6));
  FrameResult result = service_.detect(noise_frame());
  EXPECT_EQ(result.objects[0].status, SearchStatus::kAbsent);
  EXPECT_EQ(result.objects[0].threshold, 1e6);
  EXPECT_EQ(result.objects[1].status, SearchStatus::kOptimal);
  const CommandAnswer answer = done(command(CommandKind::kThreshold, "", 2e6));
  EXPECT_EQ(answer.objects[1].threshold, 2e6);
  done(command(CommandKind::kThreshold));  // NaN: as configured
  result = service_.detect(noise_frame());
  EXPECT_EQ(result.objects[0].threshold, -1e9);
  EXPECT_EQ(result.estimates.size(), 2U);
}

TEST_F(Service, ARegionIsAllThatIsLookedAt) {
  Command region = command(CommandKind::kRegion);
  region.region = {40, 30, 40, 36};
  EXPECT_THAT(done(region).message, HasSubstr("40 x 36 pixels from 40, 30"));
  const RgbdFrame frame = noise_frame();
  const FrameResult result = service_.detect(frame);
  ASSERT_EQ(result.estimates.size(), 2U);
  for (const PoseEstimate& e : result.estimates) {
    // The centre of the object is inside, in the pixels of the whole image.
    const RigidTransform mesh_from_object =
        model(e.object_name, e.object_id).model.object_from_mesh.inverse();
    const Eigen::Vector3d centre = e.camera_from_object * mesh_from_object.translation();
    const double u = frame.camera.cx + frame.camera.fx * centre.x() / centre.z();
    const double v = frame.camera.cy + frame.camera.fy * centre.y() / centre.z();
    EXPECT_GE(u, 39.5);
    EXPECT_LE(u, 80);
    EXPECT_GE(v, 29.5);
    EXPECT_LE(v, 66);
    EXPECT_GT(e.bbox[0] + e.bbox[2], 40);
  }
  region.region = {};
  EXPECT_THAT(done(region).message, HasSubstr("whole image"));
  region.region = {0, 0, 0, 100};
  EXPECT_THAT(refused(region).message, HasSubstr("too small"));
  region.region = {4000, 4000, 100, 100};
  EXPECT_THAT(refused(region).message, HasSubstr("inside the image of 96 x 72"));
  EXPECT_NO_THROW(service_.detect(noise_frame()));
}

TEST_F(Service, ARegionBesideTheFirstImageIsThatFramesErrorAndTheNextCommandHealsIt) {
  Command region = command(CommandKind::kRegion);
  region.region = {4000, 4000, 100, 100};
  done(region);  // nobody knows yet how large images are
  EXPECT_THROW(service_.detect(noise_frame()), InputError);
  region.region = {};
  done(region);
  EXPECT_NO_THROW(service_.detect(noise_frame()));
}

TEST_F(Service, WhatMakesNoSenseIsRefusedInWords) {
  EXPECT_THAT(refused(command(CommandKind::kEnable, "cup")).message, HasSubstr("loaded are: mug, can"));
  EXPECT_THAT(refused(command(CommandKind::kThreshold, "mug", INFINITY)).message, HasSubstr("absurd"));
  for (const double bad : {-1.0, 1e9, static_cast<double>(INFINITY)})
    EXPECT_THAT(refused(command(CommandKind::kDeadline, "", bad)).message, HasSubstr("0 to 600000"));
  EXPECT_THAT(refused(command(CommandKind::kUnload)).message, HasSubstr("name the object"));
  EXPECT_THAT(refused(command(CommandKind::kLoad)).message, HasSubstr("model_file is empty"));
  EXPECT_THAT(refused(command(static_cast<CommandKind>(200))).message, HasSubstr("kind 200"));
}

TEST_F(Service, ADeadlineHoldsUntilItIsTakenBack) {
  EXPECT_EQ(done(command(CommandKind::kDeadline, "", 123)).deadline_ms, 123);
  EXPECT_EQ(done(command(CommandKind::kDeadline)).deadline_ms, 0);
}

TEST_F(Service, UnloadsAndKeepsRunningWithoutModels) {
  done(command(CommandKind::kUnload, "mug"));
  EXPECT_THAT(shapes_, testing::ElementsAre("can"));
  EXPECT_THAT(names_of(service_.detect(noise_frame())), testing::ElementsAre("can"));
  EXPECT_TRUE(done(command(CommandKind::kUnload, "can")).objects.empty());
  EXPECT_TRUE(service_.detect(noise_frame()).objects.empty());
}

TEST(ServiceLoad, OnlyFromTheFoldersOfTheConfiguration) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder / "models");
  std::filesystem::create_directories(folder / "secret");
  write_model(model("cup", 3).model, folder / "models" / std::string("cup.sxm"));
  write_model(model("key", 4).model, folder / "secret" / std::string("key.sxm"));
  std::ofstream(folder / "models" / std::string("bad.sxm")) << "no model";
  DetectionSetup setup = setup_of({model("mug", 1)});
  setup.model_folders = {folder / "models"};
  DetectionService service(std::move(setup));
  const auto load = [&](const std::string& file) {
    Command c = command(CommandKind::kLoad);
    c.model_file = file;
    return service.execute(c);
  };
  CommandAnswer answer = load("cup.sxm");
  EXPECT_EQ(answer.result, CommandResult::kDone) << answer.message;
  EXPECT_EQ(answer.objects.size(), 2U);
  EXPECT_THAT(names_of(service.detect(noise_frame())), testing::ElementsAre("mug", "cup"));
  EXPECT_EQ(load((folder / "models").string() + "/cup.sxm").objects.size(), 2U);  // again: replaced
  for (const std::string& bad :
       {(folder / "secret").string() + "/key.sxm", std::string("../secret/key.sxm"),
        (folder / "models").string() + "/../secret/key.sxm", std::string("nothing.sxm"),
        std::string("bad.sxm"), std::string("."), std::string("/etc/passwd")}) {
    answer = load(bad);
    EXPECT_EQ(answer.result, CommandResult::kFailed) << bad;
    EXPECT_EQ(answer.objects.size(), 2U) << bad;
  }
}

TEST_F(Service, ALookIsAnsweredByTheFirstFrameCapturedAfterIt) {
  done(command(CommandKind::kDisable));
  const RgbdFrame before = noise_frame();
  std::vector<CommandAnswer> answers;
  const auto keep = [&](const CommandAnswer& a) { answers.push_back(a); };
  std::this_thread::sleep_for(1ms);
  service_.look(command(CommandKind::kLook, "can"), keep, 10s);
  EXPECT_TRUE(service_.detect(before).objects.empty());
  EXPECT_TRUE(answers.empty());
  const RgbdFrame after = noise_frame();
  EXPECT_TRUE(service_.detect(after).objects.empty());  // still nothing for those who did not ask
  ASSERT_EQ(answers.size(), 1U);
  EXPECT_EQ(answers[0].result, CommandResult::kDone);
  ASSERT_TRUE(answers[0].look.has_value());
  EXPECT_EQ(answers[0].look->captured_at, after.captured_at);
  EXPECT_THAT(names_of(*answers[0].look), testing::ElementsAre("can"));
  EXPECT_EQ(answers[0].look->estimates.size(), 1U);
  service_.detect(noise_frame());
  EXPECT_EQ(answers.size(), 1U);  // once
}

TEST_F(Service, ALookWithoutAFrameOrWithABadOneIsAnsweredToo) {
  std::vector<CommandAnswer> answers;
  const auto keep = [&](const CommandAnswer& a) { answers.push_back(a); };
  const auto t0 = DetectionService::Clock::now();
  service_.look(command(CommandKind::kLook, "cup"), keep, 10s);
  ASSERT_EQ(answers.size(), 1U);
  EXPECT_EQ(answers[0].result, CommandResult::kRefused);
  service_.look(command(CommandKind::kLook), keep, 10s, t0);
  service_.expire_looks(t0 + 9s);
  EXPECT_EQ(answers.size(), 1U);
  service_.expire_looks(t0 + 11s);
  ASSERT_EQ(answers.size(), 2U);
  EXPECT_EQ(answers[1].result, CommandResult::kFailed);
  EXPECT_THAT(answers[1].message, HasSubstr("no frame came"));
  service_.look(command(CommandKind::kLook), keep, 10s, t0);
  RgbdFrame bad = noise_frame();
  bad.colour.release();
  EXPECT_THROW(service_.detect(bad), InputError);
  ASSERT_EQ(answers.size(), 3U);
  EXPECT_EQ(answers[2].result, CommandResult::kFailed);
}

TEST(ServiceLook, AnOldResultIsNotGivenOutAsFresh) {
  DetectionSetup setup = setup_of({model("mug", 1)});
  setup.max_look_age_ms = 60'000;
  DetectionService service(std::move(setup));
  std::vector<CommandAnswer> answers;
  const auto keep = [&](const CommandAnswer& a) { answers.push_back(a); };
  const auto long_ago = DetectionService::Clock::now() - 1h;
  RgbdFrame old = noise_frame();
  old.captured_monotonic -= 61s;
  service.look(command(CommandKind::kLook), keep, 10s, long_ago);
  service.detect(old);
  service.look(command(CommandKind::kLook), keep, 10s, long_ago);
  service.detect(noise_frame());
  ASSERT_EQ(answers.size(), 2U);
  EXPECT_EQ(answers[0].result, CommandResult::kFailed);
  EXPECT_FALSE(answers[0].look.has_value());
  EXPECT_THAT(answers[0].message, HasSubstr("allowed are 60000 (pipeline.max_age_ms)"));
  EXPECT_EQ(answers[1].result, CommandResult::kDone);
  EXPECT_TRUE(answers[1].look.has_value());
}

TEST_F(Service, ReplacesEverythingOrNothing) {
  done(command(CommandKind::kDisable, "can"));
  DetectionSetup bad = setup_of({model("cup", 3)});
  bad.options.max_detections = 0;
  EXPECT_THROW(service_.replace(std::move(bad)), DoorError);
  EXPECT_THAT(names_of(service_.detect(noise_frame())), testing::ElementsAre("mug"));
  service_.replace(setup_of({model("cup", 3), model("can", 2)}));
  EXPECT_THAT(names_of(service_.detect(noise_frame())), testing::ElementsAre("cup", "can"));
  EXPECT_THAT(shapes_, testing::ElementsAre("cup", "can"));
}

TEST_F(Service, ACancelledSearchIsNotComplete) {
  service_.cancel();
  const FrameResult result = service_.detect(noise_frame());
  EXPECT_TRUE(result.objects.empty());
}

TEST(DetectorCall, ThresholdsBelowAndAboveTheConfiguredOneReachTheFastEngineToo) {
  DetectionSetup setup = setup_of({model("mug", 1)});
  setup.options.bound = "lanes";
  setup.options.threshold = 1e6;
  Detector detector({setup.models[0].model}, setup.options);
  EXPECT_EQ(detector.detect(noise_frame()).objects[0].status, SearchStatus::kAbsent);
  DetectCall low;
  low.thresholds["mug"] = -1e9;
  const FrameResult found = detector.detect(noise_frame(), low);
  ASSERT_EQ(found.estimates.size(), 1U);
  DetectionSetup plain = setup_of({model("mug", 1)});
  Detector twin({plain.models[0].model}, plain.options);
  EXPECT_EQ(found.estimates[0].log_score, twin.detect(noise_frame()).estimates[0].log_score);
  EXPECT_EQ(detector.detect(noise_frame()).objects[0].status, SearchStatus::kAbsent);
  DetectCall none;
  none.wanted = [](const std::string&) { return false; };
  EXPECT_TRUE(detector.detect(noise_frame(), none).objects.empty());
}

TEST(DetectorCall, StopsASearchThatIsUnderWay) {
  DetectionSetup setup = setup_of({model("mug", 1)});
  Detector detector({setup.models[0].model}, setup.options);
  int asked = 0;
  DetectCall call;
  call.stop = [&] { return ++asked > 1; };
  const FrameResult result = detector.detect(noise_frame(), call);
  ASSERT_EQ(result.objects.size(), 1U);
  EXPECT_EQ(result.objects[0].status, SearchStatus::kBounded);
  EXPECT_EQ(asked, 2);
}

TEST(LoadModels, RefusesTwoOfOneName) {
  const TemporaryFolder folder;
  write_model(model("cup", 3).model, folder / "a.sxm");
  write_model(model("cup", 4).model, folder / "b.sxm");
  EXPECT_EQ(load_models({folder / "a.sxm"}).size(), 1U);
  EXPECT_THROW(load_models({folder / "a.sxm", folder / "b.sxm"}), InputError);
}

}  // namespace
}  // namespace sextant
