// SPDX-License-Identifier: Apache-2.0
// A score that is blind to the turn of a mug: the rigid model has to tell it, and the certificate has to say
// so.
#include <gtest/gtest.h>

#include <numbers>

#include "offline/learn/bin_layout.h"
#include "offline/learn/compile.h"
#include "offline/learn/scenery.h"
#include "offline/render/renderer.h"
#include "offline/synthesize/random.h"
#include "runtime/detect/detector.h"
#include "runtime/geometry/pose_mapping.h"
#include "tests/support/rendered_frame.h"

namespace sextant {
namespace {

constexpr int kWidth = 320, kHeight = 240;
constexpr std::array<int, 3> kTurns{0, 90, 180};
constexpr int kWithinBinDeg = 6;

LearnParameters quick() {
  LearnParameters p;
  p.images_per_bin = 20;
  p.scenes_per_bin = 8;
  p.grid = 48;
  p.min_pitch_deg = p.max_pitch_deg = 40;
  p.max_roll_deg = 0;
  p.angle_tolerance_deg = 4;
  p.camera = {kWidth, kHeight, 400, 159.5, 119.5};
  return p;
}

/// The parts of one turn, for every turn, and a little more for the first: whichever way the mug is turned,
/// all turns score nearly alike.
ObjectModel blind_model(const StandingObject& object, const LearnParameters& p) {
  auto boxes = lay_out_bins(p, 360);
  std::erase_if(boxes, [](const RotationBox& b) { return b.lo_deg[2] != 0; });
  std::vector<ViewpointBin> bins;
  for (ViewpointBin bin : learn_bins(object, p, boxes, 0, 0, 1, {})) {
    const double middle = 0.5 * (bin.box.lo_deg[2] + bin.box.hi_deg[2]) * std::numbers::pi / 180;
    const auto freeze = [&](std::array<float, 4>& form) {
      form[0] += static_cast<float>(static_cast<double>(form[3]) * middle);
      form[3] = 0;
    };
    for (VisualPart& part : bin.visual) {
      freeze(part.u);
      freeze(part.v);
    }
    for (DepthPart& part : bin.depth) freeze(part.d);
    const int width = bin.box.hi_deg[2] - bin.box.lo_deg[2];
    for (const int turn : kTurns) {
      bin.box.lo_deg[2] = turn;
      bin.box.hi_deg[2] = turn + width;
      bins.push_back(bin);
      if (turn == kTurns[0]) continue;
      for (VisualPart& part : bins.back().visual) part.seen.weight *= 0.97F;
      for (DepthPart& part : bins.back().depth) part.seen.weight *= 0.97F;
    }
  }
  return assemble_model(object, p, std::move(bins), "mug.stl", 3);
}

TEST(OtherTurn, TheRigidModelTellsWhatTheScoreCannotAndTheCertificateSaysSo) {
  MeshOptions mesh_options;
  mesh_options.metres_per_unit = 0.001;
  mesh_options.up = "z";
  const StandingObject object =
      load_standing_object(std::filesystem::path(SEXTANT_SOURCE_DIR) / "data/meshes/mug.stl", mesh_options);
  const LearnParameters p = quick();
  DetectOptions options;
  options.tolerance.angle_rad = 0.07;
  options.false_positive_rate = 1;
  const ObjectModel model = blind_model(object, p);
  Detector detector({model}, options);

  Renderer renderer;
  const Scenery scenery(renderer);
  const int mesh = renderer.upload(object.mesh);
  const TableGeometry table = TableGeometry::from_pitch_roll(40 * std::numbers::pi / 180, 0, 0.6);
  const UprightPose up = upright_pose_at(p.camera, table.up_in_camera, 170, 120);
  const double z = (table.camera_height_m - object.centre_height_m) / up.sine_of_elevation;
  for (const int turn : kTurns) {
    const double rz = (turn + kWithinBinDeg) * std::numbers::pi / 180;
    const RigidTransform truth = transform_from_pose(p.camera, {170, 120, z, up.rx, up.ry, rz});
    const RigidTransform foot = truth * Eigen::Translation3d(0, 0, -object.centre_height_m);
    const RenderedView view = renderer.render(p.camera, {0, 0, kWidth, kHeight},
                                              {{mesh, truth}, {scenery.textured_tables.at(0), foot}},
                                              {{-0.5, -1, 0}, 0.5}, {150, 140, 130});
    const FrameResult result = detector.detect(frame_of(view, p.camera, table));
    ASSERT_EQ(1U, result.estimates.size()) << turn;
    const PoseEstimate& e = result.estimates[0];
    const RigidTransform found = e.camera_from_object * model.object_from_mesh.inverse();
    EXPECT_LT((found.translation() - truth.translation()).norm(), 0.01) << turn;
    EXPECT_LT(rotation_angle_between(found, truth), 15 * std::numbers::pi / 180) << turn;
    // What the certificate says belongs to the pose that is reported.
    ASSERT_EQ(1U, result.objects.size());
    EXPECT_EQ(SearchStatus::kOptimal, result.objects[0].status);
    EXPECT_NEAR(e.upper_bound, e.log_score + e.gap, 1e-9);
    EXPECT_EQ(turn != kTurns[0], e.refinement.other_turn) << turn;
    EXPECT_EQ(e.refinement.other_turn, e.gap > 0) << turn;
    EXPECT_EQ(e.refinement.other_turn ? SearchStatus::kBounded : SearchStatus::kOptimal, e.status) << turn;
    if (!e.refinement.other_turn) continue;
    EXPECT_EQ(0, e.runner_up_margin);
    EXPECT_FALSE(e.runner_up_exact);
  }
}

}  // namespace
}  // namespace sextant
