// SPDX-License-Identifier: Apache-2.0
// The whole of learning on a real mesh with the real renderer, and detection of what was rendered.
#include "offline/learn/compile.h"

#include <gtest/gtest.h>

#include <unistd.h>

#include <numbers>

#include "offline/learn/bin_layout.h"
#include "offline/learn/worker_processes.h"
#include "offline/render/renderer.h"
#include "runtime/base/error.h"
#include "runtime/detect/detector.h"
#include "runtime/geometry/pose_mapping.h"
#include "runtime/model/model_file.h"

namespace sextant {
namespace {

const std::filesystem::path kMesh = std::filesystem::path(SEXTANT_SOURCE_DIR) / "data/meshes/printed_box.obj";

LearnParameters quick() {
  LearnParameters p;
  p.images_per_bin = 24;
  p.scenes_per_bin = 12;
  p.grid = 48;
  p.min_pitch_deg = 40;
  p.max_pitch_deg = 40;
  p.max_roll_deg = 0;
  p.angle_tolerance_deg = 4;
  p.camera = {320, 240, 400, 159.5, 119.5};
  return p;
}

StandingObject box() {
  MeshOptions o;
  o.metres_per_unit = 0.001;
  o.up = "z";
  return load_standing_object(kMesh, o);
}

ObjectModel compile(const StandingObject& object, const LearnParameters& p, int workers) {
  // Two sides of the box are enough here.
  auto boxes = lay_out_bins(p, 360);
  std::erase_if(boxes, [](const RotationBox& b) { return b.lo_deg[2] < 20 || b.hi_deg[2] > 60; });
  return assemble_model(object, p, learn_bins(object, p, boxes, workers, 0, 1, {}), "printed_box.obj", 7);
}

TEST(Compile, IsByteIdenticalForAnyNumberOfWorkersAndRanks) {
  const StandingObject object = box();
  LearnParameters p = quick();
  p.images_per_bin = 12;
  p.scenes_per_bin = 4;
  const auto one = encode_model(compile(object, p, 1));
  EXPECT_EQ(encode_model(compile(object, p, 3)), one);
  // As two ranks would do it.
  auto boxes = lay_out_bins(p, 360);
  std::erase_if(boxes, [](const RotationBox& b) { return b.lo_deg[2] < 20 || b.hi_deg[2] > 60; });
  auto even = learn_bins(object, p, boxes, 1, 0, 2, {});
  const auto odd = learn_bins(object, p, boxes, 1, 1, 2, {});
  for (std::size_t i = 1; i < even.size(); i += 2) even[i] = odd[i];
  EXPECT_EQ(encode_model(assemble_model(object, p, even, "printed_box.obj", 7)), one);
  p.seed = 2;
  EXPECT_NE(encode_model(compile(object, p, 1)), one);
}

TEST(Compile, WhatWasLearntIsFoundAgain) {
  const StandingObject object = box();
  const LearnParameters p = quick();
  const ObjectModel model = decode_model(encode_model(compile(object, p, 0)), "test");
  EXPECT_EQ(model.object_id, 7);

  // The box on a table, 40 deg below the camera, turned by 40 deg.
  const TableGeometry table = TableGeometry::from_pitch_roll(40 * std::numbers::pi / 180, 0, 0.62);
  const UprightPose up = upright_pose_at(p.camera, table.up_in_camera, 170, 110);
  const double z = (0.62 - model.centre_height_m) / up.sine_of_elevation;
  const Pose6 truth{170, 110, z, up.rx, up.ry, 40 * std::numbers::pi / 180};
  Renderer renderer;
  const int mesh = renderer.upload(object.mesh);
  const RigidTransform camera_from_object = transform_from_pose(p.camera, truth);
  const RenderedView view = renderer.render(p.camera, {0, 0, 320, 240}, {{mesh, camera_from_object}},
                                            {{-0.5, -1, 0}, 0.5}, {150, 140, 130});
  RgbdFrame frame;
  frame.colour = view.colour;
  frame.camera = {320, 240, 400, 400, 159.5, 119.5, {}};
  frame.axial_depth_m = view.ray_depth_m.clone();
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 320; ++x)
      frame.axial_depth_m.at<float>(y, x) *= static_cast<float>(p.camera.ray(x, y).z());
  }
  frame.table = table;
  for (const char* scoring : {"likelihood", "thesis"}) {
    DetectOptions options;
    options.scoring = scoring;
    options.tolerance.angle_rad = 0.07;
    Detector detector({model}, options);
    const FrameResult result = detector.detect(frame);
    ASSERT_EQ(result.estimates.size(), 1U) << scoring;
    const PoseEstimate& e = result.estimates[0];
    const RigidTransform expected = camera_from_object * model.object_from_mesh;
    EXPECT_EQ(e.status, SearchStatus::kOptimal);
    EXPECT_EQ(e.gap, 0);
    EXPECT_LT((e.camera_from_object.translation() - expected.translation()).norm(), 0.002) << scoring;
    EXPECT_LT(rotation_angle_between(e.camera_from_object, expected), 0.02) << scoring;
    EXPECT_EQ(result.objects[0].coverage, 1);
  }
}

TEST(WorkerProcesses, BringErrorsAndDeathsHome) {
  const auto nothing = [](std::size_t, std::span<const std::byte>) {};
  EXPECT_THROW(run_worker_processes(
                   2,
                   [](int w, const Deliver&) {
                     if (w == 1) throw InputError("mesh", "bad");
                   },
                   nothing),
               InputError);
  EXPECT_THROW(run_worker_processes(
                   2,
                   [](int w, const Deliver&) {
                     if (w == 0) _exit(9);
                   },
                   nothing),
               DeviceError);
  std::vector<int> seen(64, 0);
  run_worker_processes(
      3,
      [](int w, const Deliver& deliver) {
        const std::vector<std::byte> big(100000, std::byte{7});
        for (std::size_t i = static_cast<std::size_t>(w); i < 64; i += 3) deliver(i, big);
      },
      [&](std::size_t item, std::span<const std::byte> bytes) {
        seen.at(item) += bytes.size() == 100000 ? 1 : 100;
      });
  for (const int n : seen) EXPECT_EQ(n, 1);
}

}  // namespace
}  // namespace sextant
