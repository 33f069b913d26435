// SPDX-License-Identifier: Apache-2.0
// What the detector makes of the places that the search found, on frames with two boxes.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>

#include "offline/learn/bin_layout.h"
#include "offline/learn/compile.h"
#include "offline/learn/scenery.h"
#include "offline/render/renderer.h"
#include "offline/synthesize/random.h"
#include "runtime/detect/detector.h"
#include "runtime/geometry/pose_mapping.h"
#include "runtime/refine/confidence.h"
#include "tests/support/rendered_frame.h"

namespace sextant {
namespace {

constexpr int kWidth = 320, kHeight = 240, kScenes = 6;

class DetectorWithTwoBoxes : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    LearnParameters p;
    p.images_per_bin = 20;
    p.scenes_per_bin = 8;
    p.grid = 48;
    p.min_pitch_deg = p.max_pitch_deg = 40;
    p.max_roll_deg = 0;
    p.angle_tolerance_deg = 4;
    p.camera = {kWidth, kHeight, 400, 159.5, 119.5};
    MeshOptions mesh_options;
    mesh_options.metres_per_unit = 0.001;
    mesh_options.up = "z";
    const StandingObject object = load_standing_object(
        std::filesystem::path(SEXTANT_SOURCE_DIR) / "data/meshes/printed_box.obj", mesh_options);
    auto boxes = lay_out_bins(p, 360);
    std::erase_if(boxes, [](const RotationBox& b) { return b.lo_deg[2] != 40; });
    model_ = std::make_unique<ObjectModel>(
        assemble_model(object, p, learn_bins(object, p, boxes, 0, 0, 1, {}), "printed_box.obj", 7));

    // Two boxes in every frame among things.
    Renderer renderer;
    const Scenery scenery(renderer);
    const int mesh = renderer.upload(object.mesh);
    const TableGeometry table = TableGeometry::from_pitch_roll(40 * std::numbers::pi / 180, 0, 0.7);
    Random random(5);
    for (int i = 0; i < kScenes; ++i) {
      std::vector<RenderItem> items;
      for (const double x : {90.0, 230.0}) {
        const double y = random.uniform(100, 140);
        const UprightPose up = upright_pose_at(p.camera, table.up_in_camera, x, y);
        const double z = (table.camera_height_m - object.centre_height_m) / up.sine_of_elevation;
        const double rz = random.uniform(42, 58) * std::numbers::pi / 180;
        const RigidTransform pose = transform_from_pose(p.camera, {x, y, z, up.rx, up.ry, rz});
        const RigidTransform foot = pose * Eigen::Translation3d(0, 0, -object.centre_height_m);
        if (items.empty()) items.push_back({scenery.textured_tables.at(static_cast<std::size_t>(i)), foot});
        items.push_back({mesh, pose});
        const auto thing = static_cast<std::size_t>(random.integer(0, 19));
        const double away = 0.8 * object.bounding_radius_m + scenery.things.at(thing).radius_m;
        // Beside or before it: hides more or less of it.
        const double where = random.uniform(0, 2 * std::numbers::pi);
        const Eigen::Translation3d beside(away * std::cos(where), away * std::sin(where), 0);
        items.push_back({scenery.things.at(thing).mesh, foot * beside});
      }
      const RenderedView view =
          renderer.render(p.camera, {0, 0, kWidth, kHeight}, items, {{-0.5, -1, 0}, 0.5}, {150, 140, 130});
      frames_.push_back(frame_of(view, p.camera, table));
    }
  }
  static void TearDownTestSuite() {
    model_.reset();
    frames_.clear();
  }

  /// The model with a constant added to what its confidence is computed from.
  static ObjectModel with_bias(float bias) {
    ObjectModel model = *model_;
    model.confidence.weights = general_confidence_weights();
    model.confidence.weights[0] += bias;
    model.confidence.calibrated = true;
    return model;
  }

  static FrameResult detected(const RgbdFrame& frame, const ObjectModel& model, int most, int candidates,
                              const std::string& bound = "lanes") {
    DetectOptions options;
    options.tolerance.angle_rad = 0.07;
    options.false_positive_rate = 1;
    options.max_detections = most;
    options.candidates = candidates;
    options.bound = bound;
    options.threads = 1;  // counts are exact
    return Detector({model}, options).detect(frame);
  }

  static std::unique_ptr<ObjectModel> model_;
  static std::vector<RgbdFrame> frames_;
};
std::unique_ptr<ObjectModel> DetectorWithTwoBoxes::model_;
std::vector<RgbdFrame> DetectorWithTwoBoxes::frames_;

// The same answer as of two detections that are searched at once.
TEST_F(DetectorWithTwoBoxes, TheMoreCertainOfTwoIsTheAnswerWhereTheBestIsDoubtful) {
  const ObjectModel doubtful = with_bias(-20);
  int second = 0, first = 0;
  for (const RgbdFrame& frame : frames_) {
    const FrameResult both = detected(frame, doubtful, 2, 1);
    const FrameResult one = detected(frame, doubtful, 1, 2);
    ASSERT_EQ(2U, both.estimates.size());
    ASSERT_EQ(1U, one.estimates.size());
    const PoseEstimate& best = both.estimates[0];
    const PoseEstimate& next = both.estimates[1];
    const PoseEstimate& e = one.estimates[0];
    ASSERT_LT(best.score, 0.5);
    const bool other = next.score > best.score && next.log_score >= 0.9 * best.log_score;
    ++(other ? second : first);
    const PoseEstimate& wanted = other ? next : best;
    EXPECT_TRUE(e.camera_from_object.isApprox(wanted.camera_from_object, 0));
    EXPECT_EQ(wanted.log_score, e.log_score);
    EXPECT_EQ(wanted.score, e.score);
    // The certificate speaks of what was not reported, too.
    EXPECT_NEAR(other ? best.log_score - next.log_score : best.gap, e.gap, 1e-9);
    EXPECT_EQ(other ? SearchStatus::kBounded : best.status, e.status);
    EXPECT_EQ(SearchStatus::kOptimal, one.objects.at(0).status);
    // The plain search looks further the same way.
    const FrameResult plain = detected(frame, doubtful, 1, 2, "window");
    ASSERT_EQ(1U, plain.estimates.size());
    EXPECT_TRUE(e.camera_from_object.isApprox(plain.estimates[0].camera_from_object, 0));
    EXPECT_EQ(e.gap, plain.estimates[0].gap);
  }
  EXPECT_GT(second, 0);
  EXPECT_GT(first, 0);
}

TEST_F(DetectorWithTwoBoxes, NoOtherPlaceIsLookedAtWhereTheBestIsSureOrNobodyAsks) {
  for (const RgbdFrame& frame : frames_) {
    const FrameResult alone = detected(frame, with_bias(-20), 1, 1);
    const FrameResult doubtful = detected(frame, with_bias(-20), 1, 2);
    const FrameResult sure = detected(frame, with_bias(20), 1, 2);
    const FrameResult sure_alone = detected(frame, with_bias(20), 1, 1);
    ASSERT_EQ(1U, alone.estimates.size());
    ASSERT_EQ(1U, sure.estimates.size());
    EXPECT_GT(sure.estimates[0].score, 0.5);
    EXPECT_TRUE(sure.estimates[0].camera_from_object.isApprox(alone.estimates[0].camera_from_object, 0));
    EXPECT_EQ(alone.estimates[0].gap, sure.estimates[0].gap);
    EXPECT_GT(doubtful.nodes, alone.nodes);
    EXPECT_EQ(sure.objects.at(0).upper_bound, sure_alone.objects.at(0).upper_bound);
  }
}

TEST_F(DetectorWithTwoBoxes, ModelsOfOneMeshAndIdAreOneObjectOthersAreNot) {
  ObjectModel other_mesh = *model_;
  ++other_mesh.provenance.mesh_hash;
  ObjectModel other_id = *model_;
  ++other_id.object_id;
  DetectOptions options;
  options.tolerance.angle_rad = 0.07;
  options.false_positive_rate = 1;
  options.candidates = 1;
  const auto answers = [&](const ObjectModel& second) {
    return Detector({*model_, second}, options).detect(frames_[0]).estimates;
  };
  EXPECT_EQ(1U, answers(*model_).size());
  for (const ObjectModel& second : {other_mesh, other_id}) {
    const std::vector<PoseEstimate> both = answers(second);
    ASSERT_EQ(2U, both.size());
    EXPECT_EQ(0U, both[0].model_index);
    EXPECT_EQ(1U, both[1].model_index);
    EXPECT_TRUE(both[0].camera_from_object.isApprox(both[1].camera_from_object, 0));
  }
}

}  // namespace
}  // namespace sextant
