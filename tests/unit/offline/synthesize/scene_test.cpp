// SPDX-License-Identifier: Apache-2.0
#include "offline/synthesize/scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/core.hpp>

#include "offline/synthesize/textures.h"
#include "runtime/base/error.h"
#include "runtime/geometry/pose_mapping.h"

namespace sextant {
namespace {

TEST(Scene, TheCameraIsWhereTheTableGeometrySays) {
  for (const double pitch : {0.3, 0.8, 1.3}) {
    for (const double roll : {-0.4, 0.0, 0.2}) {
      const RigidTransform camera_from = camera_from_world(pitch, roll, 0.7);
      const TableGeometry table = TableGeometry::from_pitch_roll(pitch, roll, 0.7);
      EXPECT_NEAR(1, camera_from.linear().determinant(), 1e-12);
      EXPECT_TRUE((camera_from.linear() * Eigen::Vector3d::UnitZ()).isApprox(table.up_in_camera, 1e-12));
      // A point of the table lies in the table's plane.
      EXPECT_NEAR(-0.7, table.up_in_camera.dot(camera_from * Eigen::Vector3d(0.3, 0.9, 0)), 1e-12);
    }
  }
}

const std::vector<Footprint> kNone;

TEST(Scene, TargetsStandUprightInsideThePictureAndTouchNothing) {
  SceneOptions options;
  TextureLibrary textures(1);
  const std::vector<Footprint> targets{{0.12, 0.06, 0.1, {0.08, 0.08, 0.2}},
                                       {0.09, 0.08, 0.05, {0.1, 0.12, 0.1}}};
  const ClutterStock stock{textures, targets, kNone, 0.3, 0};
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    Random random(seed);
    TableScene scene = compose_scene(options, targets, stock, random);
    ASSERT_EQ(2U, scene.world_from_target.size());
    for (std::size_t i = 0; i < targets.size(); ++i) {
      const RigidTransform camera_from_object = scene.camera_from_world * scene.world_from_target[i];
      const Pose6 pose = pose_from_transform(options.camera, camera_from_object);
      TableTolerance exact;
      exact.height_m = 1e-6;
      exact.angle_rad = 1e-6;
      EXPECT_TRUE(
          table_constraint_contains(options.camera, scene.table, targets[i].centre_height_m, exact, pose));
      EXPECT_GE(pose.z, options.distance_m.lo);
      EXPECT_LE(pose.z, options.distance_m.hi);
      const double reach =
          options.camera.focal * targets[i].bounding_radius_m / camera_from_object.translation().z();
      EXPECT_GE(pose.x, reach);
      EXPECT_LE(pose.y, options.camera.height - reach);
    }
    // No vertex of the clutter stands within a target's footprint.
    EXPECT_EQ(scene.taken.size(), targets.size() + scene.surroundings.size() - scene.first_clutter);
    for (std::size_t k = scene.first_clutter; k < scene.surroundings.size(); ++k) {
      const PlacedMesh& placed = scene.surroundings[k];
      for (const Eigen::Vector3f& v : placed.mesh.vertices) {
        const Eigen::Vector3d p = placed.world_from_mesh * v.cast<double>();
        EXPECT_GE(p.z(), -1e-6);
        for (std::size_t i = 0; i < targets.size(); ++i) {
          const Eigen::Vector2d away = p.head<2>() - scene.world_from_target[i].translation().head<2>();
          EXPECT_GT(away.norm(), targets[i].horizontal_radius_m);
        }
      }
    }
    EXPECT_GT(scene.surroundings.size(), scene.first_clutter);
    const Disc last = scene.taken.back();
    remove_clutter(scene, scene.first_clutter);
    EXPECT_TRUE(scene.taken.size() == targets.size() || scene.taken.back().centre == last.centre);
  }
}

TEST(Scene, OccludersStandBetweenTheCameraAndTheirTarget) {
  SceneOptions options;
  options.clutter = {0, 0};
  TextureLibrary textures(2);
  const std::vector<Footprint> targets{{0.12, 0.06, 0.1, {0.08, 0.08, 0.2}}};
  const ClutterStock stock{textures, targets, kNone, 0, 0};
  int added = 0;
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    Random random(seed);
    TableScene scene = compose_scene(options, targets, stock, random);
    if (!add_occluder(scene, 0, targets[0], 0.3, stock, random)) continue;
    ++added;
    ASSERT_EQ(2U, scene.taken.size());
    EXPECT_LT(scene.taken[1].centre.norm(), scene.taken[0].centre.norm());
    EXPECT_GT((scene.taken[1].centre - scene.taken[0].centre).norm(), scene.taken[1].radius + 0.06);
  }
  EXPECT_GE(added, 5);
}

TEST(Scene, TheBorderCutsThoseItShallCut) {
  SceneOptions options;
  options.cut_share = 1;
  TextureLibrary textures(3);
  const std::vector<Footprint> targets{{0.12, 0.06, 0.1, {0.08, 0.08, 0.2}}};
  const ClutterStock stock{textures, targets, kNone, 0, 0};
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    Random random(seed);
    const TableScene scene = compose_scene(options, targets, stock, random);
    const Eigen::Vector3d centre = scene.camera_from_world * scene.world_from_target[0].translation();
    const Eigen::Vector2d pixel = options.camera.project(centre);
    const double reach = options.camera.focal * targets[0].bounding_radius_m / centre.z();
    const double margin =
        std::min({pixel.x(), options.camera.width - 1 - pixel.x(), options.camera.height - 1 - pixel.y()});
    EXPECT_GT(margin, 0);
    EXPECT_LT(margin, 1.05 * reach);
  }
}

TEST(Scene, ImpossibleWishesAreRefused) {
  SceneOptions options;
  options.height_m = {0.2, 0.2};
  options.distance_m = {3, 4};
  Random random(1);
  TextureLibrary textures(1);
  const ClutterStock stock{textures, kNone, kNone, 0, 0};
  EXPECT_THROW(compose_scene(options, {{0.1, 0.1, 0.1, {0.1, 0.1, 0.1}}}, stock, random), UsageError);
}

TEST(Textures, HaveStructureAndDependOnTheSeedAlone) {
  const cv::Size size(128, 96);
  for (const auto make : {wood_texture, plain_texture, cloth_texture, stone_texture, tile_texture,
                          print_texture, checker_texture, striped_texture, carpet_texture, terrazzo_texture,
                          page_texture, table_texture, floor_texture, wall_texture}) {
    for (std::uint64_t seed = 0; seed < 5; ++seed) {
      Random random(seed);
      const cv::Mat texture = make(size, random);
      ASSERT_EQ(size, texture.size());
      ASSERT_EQ(CV_8UC3, texture.type());
      cv::Scalar mean;
      cv::Scalar deviation;
      cv::meanStdDev(texture, mean, deviation);
      EXPECT_GT(deviation[0] + deviation[1] + deviation[2], 1.0);
      Random again(seed);
      EXPECT_EQ(0, cv::norm(texture, make(size, again), cv::NORM_INF));
    }
  }
}

TEST(TextureLibrary, GivesTheSameForTheSameSeedsAndAnotherStockForAnother) {
  TextureLibrary one(5);
  TextureLibrary same(5);
  TextureLibrary other(6);
  for (const TextureKind kind : {TextureKind::kFloor, TextureKind::kPrint}) {
    Random a(3);
    Random b(3);
    Random c(3);
    one.pick(kind, a);
    same.pick(kind, b);
    other.pick(kind, c);
    const cv::Mat first = one.pick(kind, a);
    EXPECT_EQ(0, cv::norm(first, same.pick(kind, b), cv::NORM_INF));
    const cv::Mat another = other.pick(kind, c);
    EXPECT_TRUE(another.size() != first.size() || cv::norm(first, another, cv::NORM_INF) > 0);
  }
}

TEST(Textures, HsvCorners) {
  EXPECT_TRUE(colour_from_hsv(0, 1, 1).isApprox(Eigen::Vector3d(1, 0, 0)));
  EXPECT_TRUE(colour_from_hsv(1 / 3.0, 1, 1).isApprox(Eigen::Vector3d(0, 1, 0), 1e-9));
  EXPECT_TRUE(colour_from_hsv(2 / 3.0, 1, 0.5).isApprox(Eigen::Vector3d(0, 0, 0.5), 1e-9));
  EXPECT_TRUE(colour_from_hsv(0.3, 0, 0.7).isApprox(Eigen::Vector3d(0.7, 0.7, 0.7)));
}

}  // namespace
}  // namespace sextant
