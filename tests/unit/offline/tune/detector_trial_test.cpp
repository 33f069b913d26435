// SPDX-License-Identifier: Apache-2.0
// The real trial on a small data set: learnt, searched, judged.
#include "offline/tune/detector_trial.h"

#include <gtest/gtest.h>

#include "offline/synthesize/synthesize.h"
#include "runtime/base/error.h"
#include "tests/support/simple_objects.h"
#include "tests/support/temporary_folder.h"

namespace sextant {
namespace {

TEST(ImageHalves, DealOutThoseWithTheObjectAndThoseWithout) {
  std::vector<BopImage> images(7);
  for (int i = 0; i < 7; ++i) {
    images[static_cast<std::size_t>(i)].image_id = i;
    if (i < 4)
      images[static_cast<std::size_t>(i)].ground_truth.push_back({9, RigidTransform::Identity(), {}, {}});
  }
  const ImageHalves halves = split_images(images, 9);
  const auto ids = [](const std::vector<BopImage>& half) {
    std::vector<int> result;
    for (const BopImage& image : half) result.push_back(image.image_id);
    return result;
  };
  EXPECT_EQ((std::vector<int>{0, 2, 4, 6}), ids(halves.training));
  EXPECT_EQ((std::vector<int>{1, 3, 5}), ids(halves.held_out));
}

TEST(DetectorTrial, LearnsSearchesAndJudges) {
  const TemporaryFolder folder;
  SynthesisOptions set;
  set.output = folder / "set";
  set.images = 2;
  set.sensor = "none";
  set.scene.camera = {160, 120, 131.25, 79.5, 59.5};
  set.scene.pitch_deg = {38, 40};
  set.scene.roll_deg = {0, 0};
  set.scene.clutter = {0, 1};
  set.scene.occlusion = {0, 0.1};
  DetectorTrialOptions options;
  options.object = box_object(0.04, 0.06, 0.09);
  synthesize_dataset({{1, options.object}}, {}, set, {});

  options.mesh_name = "box";
  options.folder = folder / "tune";
  options.images = split_images(open_bop_dataset(folder / "set", "test").images, 1);
  LearnParameters& learn = options.base.learn;
  learn.images_per_bin = 10;
  learn.scenes_per_bin = 4;
  learn.grid = 32;
  learn.bin_width_deg = 30;
  learn.min_pitch_deg = 38;
  learn.max_pitch_deg = 40;
  learn.max_roll_deg = 0;
  learn.angle_tolerance_deg = 3;
  learn.camera = set.scene.camera;
  options.base = apply(options.base, {});
  EXPECT_THROW(detector_trial([&] {
                 DetectorTrialOptions other = options;
                 other.object_id = 5;
                 return other;
               }()),
               InputError);
  const Trial trial = detector_trial(options);
  const TrialScore score = trial({}, Half::kTraining);
  EXPECT_EQ(1, score.images);
  EXPECT_EQ(1, score.instances);
  EXPECT_GT(score.seconds, 0);
  EXPECT_GE(score.share_right, 0);
  EXPECT_LE(score.share_right, 1);
  const auto models = [&] {
    return std::distance(std::filesystem::directory_iterator(folder / "tune/models"),
                         std::filesystem::directory_iterator());
  };
  EXPECT_EQ(1, models());
  // Another point with the same learning parameters takes the same model.
  trial({{"height_tolerance_m", "0.02"}}, Half::kTraining);
  EXPECT_EQ(1, models());
  trial({{"depth_parts", "40"}}, Half::kTraining);
  EXPECT_EQ(2, models());
}

}  // namespace
}  // namespace sextant
