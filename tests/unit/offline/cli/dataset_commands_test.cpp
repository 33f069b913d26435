// SPDX-License-Identifier: Apache-2.0
// `sextant synthesize` and `sextant evaluate` as a user calls them, one feeding the other.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "hal/playback/bop_dataset.h"
#include "offline/cli/evaluate_command.h"
#include "offline/cli/object_id.h"
#include "offline/cli/synthesize_command.h"
#include "offline/dataset/bop_results.h"
#include "offline/dataset/models_info.h"
#include "offline/dataset/ply_writer.h"
#include "runtime/base/error.h"
#include "tests/support/simple_objects.h"
#include "tests/support/temporary_folder.h"

namespace sextant {
namespace {

struct Outcome {
  int exit_code = -1;
  std::string output;
};

Outcome call(const std::string& command_line) {
  CLI::App app("test", "sextant");
  Outcome outcome;
  add_synthesize_command(app, outcome.exit_code);
  add_evaluate_command(app, outcome.exit_code);
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

class DatasetCommands : public testing::Test {
 protected:
  DatasetCommands() { write_ply_mm(mesh_, box_object_mesh(0.03, 0.05, 0.08), RigidTransform::Identity()); }
  std::string synthesize(const std::string& more = "") const {
    return "synthesize " + mesh_.string() +
           " --units mm --up z --symmetry-deg 180 --images 2 --size 160x120 --focal 131 -o " +
           dataset_.string() + " " + more;
  }
  /// The ground truth as results, moved by shift_m.
  void write_results(double shift_m) const {
    std::vector<BopResult> results;
    for (const BopImage& image : open_bop_dataset(dataset_, "test").images) {
      for (const BopGt& gt : image.ground_truth) {
        BopResult result{image.scene_id, image.image_id, gt.object_id, 0.5, gt.camera_from_mesh, 0.1};
        result.camera_from_mesh.pretranslate(Eigen::Vector3d(shift_m, 0, 0));
        results.push_back(result);
      }
    }
    write_bop_results(csv_, results);
  }
  TemporaryFolder folder_;
  std::filesystem::path mesh_ = folder_ / "box_000042.ply";
  std::filesystem::path dataset_ = folder_ / "set";
  std::filesystem::path csv_ = folder_ / "results.csv";
};

TEST_F(DatasetCommands, SynthesizeThenEvaluate) {
  const Outcome made = call(synthesize("--json --sensor realsense --clutter 2:3"));
  EXPECT_EQ(0, made.exit_code);
  const nlohmann::json json = nlohmann::json::parse(made.output);
  EXPECT_EQ(2, json["images"]);
  EXPECT_EQ(std::vector<int>{42}, json["object_ids"].get<std::vector<int>>())
      << "the number in the file's name";

  write_results(0.004);
  const std::string command = "evaluate --dataset " + dataset_.string() + " --csv " + csv_.string();
  const Outcome good = call(command + " --json --require 1 --report " + (folder_ / "r.html").string());
  EXPECT_EQ(0, good.exit_code);
  const nlohmann::json report = nlohmann::json::parse(good.output);
  EXPECT_EQ(1.0, report["total"]["share_right"]);
  EXPECT_NEAR(0.4, report["total"]["median_translation_cm"], 1e-6);
  EXPECT_EQ(1.0, report["total"]["average_precision"]);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "r.html"));

  EXPECT_EQ(1, call(command + " --max-translation-cm 0.3 --require 0.5").exit_code);
  EXPECT_EQ(0, call(command + " --max-translation-cm 0.3").exit_code);
  EXPECT_THAT(call(command + " --upright").output, testing::HasSubstr("100.0 %"));
}

TEST_F(DatasetCommands, OneObjectMayHaveOtherUnitsAndOthersStandAround) {
  const std::filesystem::path metres = folder_ / "metres_000007.ply";
  Mesh mesh = box_object_mesh(0.05, 0.03, 0.06);
  for (Eigen::Vector3f& v : mesh.vertices) v /= 1000;  // the writer multiplies by 1000
  write_ply_mm(metres, mesh, RigidTransform::Identity());
  const Outcome made =
      call("synthesize " + mesh_.string() + " " + metres.string() + "@m,z --units mm --up z --images 2 " +
           "--negatives 1 --size 160x120 --focal 131 --sensor none --json --distractor " + mesh_.string() +
           " -o " + dataset_.string());
  const nlohmann::json json = nlohmann::json::parse(made.output);
  EXPECT_EQ((std::vector<int>{42, 7}), json["object_ids"].get<std::vector<int>>());
  EXPECT_EQ(3, json["images"]);
  EXPECT_EQ(1, json["negatives"]);
  EXPECT_NEAR(2 * 0.08367, read_models_info(dataset_ / "models/models_info.json").at(7).diameter_m, 0.001);
  EXPECT_THROW(call(synthesize("--distractor " + mesh_.string() + "@furlong")), UsageError);
}

TEST_F(DatasetCommands, WrongUseIsRefused) {
  EXPECT_THROW(call(synthesize("--pitch-deg 30")), UsageError);
  EXPECT_THROW(call(synthesize("--height-m 1:x")), UsageError);
  EXPECT_THROW(call(synthesize("--object-id 1 2")), UsageError);
  EXPECT_THROW(call(synthesize("--sensor eye")), CLI::ParseError);
  EXPECT_THROW(call("evaluate --dataset " + dataset_.string() + " --csv " + csv_.string()), InputError);
}

TEST(ObjectId, IsTheFirstNumberInTheName) {
  EXPECT_EQ(5, object_id_in_name("a/b7/obj_000005.ply"));
  EXPECT_EQ(3, object_id_in_name("3cans.stl"));
  EXPECT_EQ(std::nullopt, object_id_in_name("mug.ply"));
  EXPECT_EQ(std::nullopt, object_id_in_name("x12345678901234.ply"));
}

}  // namespace
}  // namespace sextant
