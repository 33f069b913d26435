// SPDX-License-Identifier: Apache-2.0
// Whole data sets: rendered, written, read back, and held against the geometry they claim.
#include "offline/synthesize/synthesize.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "hal/playback/bop_dataset.h"
#include "offline/dataset/models_info.h"
#include "runtime/base/error.h"
#include "tests/support/random_pose.h"
#include "tests/support/simple_objects.h"
#include "tests/support/temporary_folder.h"

namespace sextant {
namespace {

const Eigen::Vector3d kHalf(0.04, 0.06, 0.09);

/// A box whose mesh frame is somewhere else than its object frame.
SynthesisTarget box_target(int id) {
  SynthesisTarget target{id, box_object(kHalf.x(), kHalf.y(), kHalf.z())};
  std::mt19937_64 random(static_cast<std::uint64_t>(id));
  target.object.object_from_mesh = random_pose(random);
  return target;
}

SynthesisOptions options_for(const std::filesystem::path& folder, int images, const std::string& sensor) {
  SynthesisOptions options;
  options.output = folder;
  options.images = images;
  options.sensor = sensor;
  options.seed = 11;
  options.scene.camera = {320, 240, 262.5, 159.5, 119.5};
  options.scene.clutter = {3, 5};
  return options;
}

std::string content(const std::filesystem::path& file) {
  std::stringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

TEST(Synthesize, GroundTruthAgreesWithTheDepthItWasRenderedWith) {
  const TemporaryFolder folder;
  const std::vector<SynthesisTarget> targets{box_target(4)};
  const SynthesisSummary summary = synthesize_dataset(targets, {}, options_for(folder.path(), 4, "none"), {});
  EXPECT_EQ(4, summary.images);
  EXPECT_EQ(4, summary.instances);
  const BopDataset dataset = open_bop_dataset(folder.path(), "test");
  ASSERT_EQ(4U, dataset.images.size());
  for (const BopImage& image : dataset.images) {
    const RgbdFrame frame = load_frame(image);
    ASSERT_TRUE(frame.table.has_value());
    ASSERT_EQ(1U, image.ground_truth.size());
    const BopGt& gt = image.ground_truth[0];
    EXPECT_EQ(4, gt.object_id);
    const RigidTransform object_from_camera =
        targets[0].object.object_from_mesh * gt.camera_from_mesh.inverse();
    // The object stands on the table.
    const Eigen::Vector3d base = object_from_camera.inverse() * Eigen::Vector3d(0, 0, -kHalf.z());
    EXPECT_NEAR(-frame.table->camera_height_m, frame.table->up_in_camera.dot(base), 1e-6);
    EXPECT_TRUE(object_from_camera.inverse().linear().col(2).isApprox(frame.table->up_in_camera, 1e-6));
    // As many pixels lie on the box's surface as the visible share of its silhouette says.
    int on_surface = 0;
    int on_table = 0;
    for (int y = 0; y < frame.camera.height; ++y) {
      for (int x = 0; x < frame.camera.width; ++x) {
        const double z = frame.axial_depth_m.at<float>(y, x);
        const Eigen::Vector3d p((x - frame.camera.cx) / frame.camera.fx * z,
                                (y - frame.camera.cy) / frame.camera.fy * z, z);
        const double furthest = (object_from_camera * p).cwiseAbs().cwiseQuotient(kHalf).maxCoeff();
        const bool above = frame.table->up_in_camera.dot(p) > -frame.table->camera_height_m + 0.002;
        on_surface += above && std::abs(furthest - 1) < 0.01 ? 1 : 0;
        on_table +=
            std::abs(frame.table->up_in_camera.dot(p) + frame.table->camera_height_m) < 0.0005 ? 1 : 0;
      }
    }
    ASSERT_TRUE(gt.visible_fraction.has_value());
    EXPECT_GE(*gt.visible_fraction, 0.49);
    ASSERT_TRUE(gt.bbox.has_value());
    const double silhouette = gt.bbox->area();
    EXPECT_GT(on_surface, 0.4 * *gt.visible_fraction * silhouette);
    EXPECT_LT(on_surface, 1.02 * *gt.visible_fraction * silhouette);
    EXPECT_GT(on_table, 0.2 * 320 * 240);
  }
  const ModelsInfo models = read_models_info(folder / "models/models_info.json");
  EXPECT_NEAR(2 * kHalf.norm(), models.at(4).diameter_m, 1e-6);
}

TEST(Synthesize, ImageDependsOnSeedAndNumberAlone) {
  const TemporaryFolder a;
  const TemporaryFolder b;
  const TemporaryFolder c;
  const std::vector<SynthesisTarget> targets{box_target(1)};
  synthesize_dataset(targets, {}, options_for(a.path(), 2, "kinect1"), {});
  synthesize_dataset(targets, {}, options_for(b.path(), 1, "kinect1"), {});
  SynthesisOptions other = options_for(c.path(), 1, "kinect1");
  other.seed = 12;
  synthesize_dataset(targets, {}, other, {});
  for (const char* file : {"test/000001/rgb/000000.png", "test/000001/depth/000000.png"}) {
    EXPECT_EQ(content(a / file), content(b / file)) << file;
    EXPECT_NE(content(a / file), content(c / file)) << file;
  }
}

TEST(Synthesize, SeveralTargetsTakeTurnsOrShareAnImage) {
  const TemporaryFolder folder;
  const std::vector<SynthesisTarget> targets{box_target(3), box_target(8)};
  std::size_t last = 0;
  synthesize_dataset(targets, {}, options_for(folder.path(), 3, "realsense"),
                     [&](std::size_t done, std::size_t total) {
                       EXPECT_EQ(last + 1, done);
                       EXPECT_EQ(3U, total);
                       last = done;
                     });
  EXPECT_EQ(3U, last);
  std::vector<int> ids;
  for (const BopImage& image : open_bop_dataset(folder.path(), "test").images) {
    for (const BopGt& gt : image.ground_truth) ids.push_back(gt.object_id);
  }
  EXPECT_EQ((std::vector<int>{3, 8, 3}), ids);

  const TemporaryFolder together;
  SynthesisOptions options = options_for(together.path(), 1, "xtion");
  options.targets_per_image = 2;
  EXPECT_EQ(2, synthesize_dataset(targets, {}, options, {}).instances);
}

TEST(Synthesize, ThreadsDoNotChangeTheImages) {
  const TemporaryFolder one;
  const TemporaryFolder many;
  const std::vector<SynthesisTarget> targets{box_target(1)};
  SynthesisOptions options = options_for(one.path(), 3, "xtion");
  options.negatives = 1;
  options.threads = 1;
  synthesize_dataset(targets, {}, options, {});
  options.output = many.path();
  options.threads = 3;
  synthesize_dataset(targets, {}, options, {});
  for (const char* file :
       {"test/000001/rgb/000002.png", "test/000001/depth/000003.png", "test/000001/scene_gt.json",
        "test/000001/scene_gt_info.json", "test/000001/scene_table.json", "models/models_info.json"}) {
    EXPECT_EQ(content(one / file), content(many / file)) << file;
  }
}

TEST(Synthesize, OcclusionLiesInTheWantedRange) {
  for (const Range wanted : {Range{0, 0}, Range{0.2, 0.4}}) {
    const TemporaryFolder folder;
    SynthesisOptions options = options_for(folder.path(), 6, "none");
    options.scene.occlusion = wanted;
    options.scene.clutter = {3, 8};
    synthesize_dataset({box_target(2)}, {}, options, {});
    for (const BopImage& image : open_bop_dataset(folder.path(), "test").images) {
      ASSERT_EQ(1U, image.ground_truth.size());
      const double hidden = 1 - image.ground_truth[0].visible_fraction.value_or(-1);
      EXPECT_GE(hidden, wanted.lo - 1e-9);
      EXPECT_LE(hidden, wanted.hi + 0.0051);
    }
  }
}

TEST(Synthesize, NegativesComeLastAndHoldNoTarget) {
  const TemporaryFolder folder;
  SynthesisOptions options = options_for(folder.path(), 2, "none");
  options.negatives = 2;
  const StandingObject bystander = box_object(0.03, 0.03, 0.05);
  const SynthesisSummary summary = synthesize_dataset({box_target(2)}, {bystander}, options, {});
  EXPECT_EQ(4, summary.images);
  EXPECT_EQ(2, summary.instances);
  const BopDataset dataset = open_bop_dataset(folder.path(), "test");
  ASSERT_EQ(4U, dataset.images.size());
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(i < 2 ? 1U : 0U, dataset.images[i].ground_truth.size());
  EXPECT_TRUE(dataset.images[3].table.has_value());
}

TEST(Synthesize, SeveralInstancesOfOneObject) {
  const TemporaryFolder folder;
  SynthesisOptions options = options_for(folder.path(), 3, "none");
  options.instances = {2, 3};
  options.scene.occlusion = {0, 0.7};
  synthesize_dataset({box_target(2)}, {}, options, {});
  for (const BopImage& image : open_bop_dataset(folder.path(), "test").images) {
    EXPECT_GE(image.ground_truth.size(), 2U);
    EXPECT_LE(image.ground_truth.size(), 3U);
    // They stand apart.
    const Eigen::Vector3d apart = image.ground_truth[0].camera_from_mesh.translation() -
                                  image.ground_truth[1].camera_from_mesh.translation();
    EXPECT_GT(apart.norm(), 0.05);
  }
}

TEST(Synthesize, TheBorderCutsAndTheCountsSaySo) {
  const TemporaryFolder folder;
  SynthesisOptions options = options_for(folder.path(), 4, "none");
  options.scene.cut_share = 1;
  options.scene.occlusion = {0, 0};
  synthesize_dataset({box_target(2)}, {}, options, {});
  int cut = 0;
  for (const BopImage& image : open_bop_dataset(folder.path(), "test").images) {
    const double visible = image.ground_truth.at(0).visible_fraction.value_or(-1);
    EXPECT_GE(visible, 0.59);
    const cv::Rect2d box = image.ground_truth[0].bbox.value_or(cv::Rect2d());
    const bool outside = box.x < 0 || box.x + box.width > 320 || box.y + box.height > 240;
    EXPECT_EQ(outside, visible < 0.999);
    cut += outside ? 1 : 0;
  }
  EXPECT_GE(cut, 2);
}

TEST(Synthesize, RefusesOptionsThatMakeNoSense) {
  const TemporaryFolder folder;
  const SynthesisOptions good = options_for(folder.path(), 1, "none");
  EXPECT_THROW(synthesize_dataset({}, {}, good, {}), UsageError);
  EXPECT_THROW(synthesize_dataset({box_target(1), box_target(1)}, {}, good, {}), UsageError);
  SynthesisOptions bad = good;
  bad.images = 0;
  EXPECT_THROW(synthesize_dataset({box_target(1)}, {}, bad, {}), UsageError);
  bad = good;
  bad.scene.occlusion = {0.5, 0.2};
  EXPECT_THROW(synthesize_dataset({box_target(1)}, {}, bad, {}), UsageError);
  bad = good;
  bad.instances = {0, 1};
  EXPECT_THROW(synthesize_dataset({box_target(1)}, {}, bad, {}), UsageError);
  bad = good;
  bad.sensor = "eye";
  EXPECT_THROW(synthesize_dataset({box_target(1)}, {}, bad, {}), UsageError);
  bad = good;
  bad.scene.pitch_deg = {50, 30};
  EXPECT_THROW(synthesize_dataset({box_target(1)}, {}, bad, {}), UsageError);
  bad = good;
  bad.targets_per_image = 2;
  EXPECT_THROW(synthesize_dataset({box_target(1)}, {}, bad, {}), UsageError);
}

TEST(Synthesize, AModelStandsInForItsMesh) {
  ObjectModel model;
  model.mesh.vertices = {{0, 0, 0}, {0.1F, 0, 0}, {0, 0.1F, 0}, {0, 0, 0.1F}};
  model.mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}, {1, 1, 2}};
  model.bounding_radius_m = 0.1;
  model.centre_height_m = 0.03;
  model.symmetry_deg = 180;
  const StandingObject object = standing_object_of(model);
  EXPECT_EQ(4U, object.mesh.triangle_count()) << "the triangle without area is left out";
  EXPECT_EQ(0.03, object.centre_height_m);
  EXPECT_EQ(180, object.symmetry_deg);
  EXPECT_TRUE(object.mesh.normals[0].isApprox(Eigen::Vector3f(0, 0, -1)));
  model.mesh.triangles.clear();
  EXPECT_THROW(standing_object_of(model), InputError);
}

}  // namespace
}  // namespace sextant
