// SPDX-License-Identifier: Apache-2.0
// Results that are perturbed by a known amount must be reported with exactly that error.
#include "offline/evaluate/evaluation.h"

#include <gtest/gtest.h>

#include "runtime/base/error.h"

namespace sextant {
namespace {

RigidTransform at(double x, double y, double z) { return RigidTransform(Eigen::Translation3d(x, y, z)); }

class Evaluation : public testing::Test {
 protected:
  Evaluation() {
    EvaluatedObject box;
    box.diameter_m = 0.2;
    box.centre_m = Eigen::Vector3d(0, 0, 0.05);
    for (int i = 0; i < 8; ++i)
      box.points.emplace_back(i & 1 ? 0.05 : -0.05, i & 2 ? 0.05 : -0.05, i & 4 ? 0.1 : 0.0);
    objects_[1] = box;
    box.symmetry = SymmetryGroup::about(Eigen::Vector3d::UnitZ(), 0);
    objects_[2] = box;
    // Images 0..2 hold object 1; image 1 object 2 as well; image 3 nothing.
    for (int i = 0; i < 4; ++i) {
      BopImage image;
      image.scene_id = 1;
      image.image_id = i;
      image.camera.fx = image.camera.fy = 500;
      image.camera.cx = 320;
      image.camera.cy = 240;
      if (i < 3) image.ground_truth.push_back({1, at(0, 0, 0.8), 1.0 - 0.3 * i, std::nullopt});
      if (i == 1) image.ground_truth.push_back({2, at(0.2, 0, 0.8), std::nullopt, std::nullopt});
      images_.push_back(image);
    }
  }
  void detect(int image, int object, const RigidTransform& pose, double score = 0.5) {
    results_.push_back({1, image, object, score, pose, 0.25});
  }
  EvaluationReport report() const { return evaluate(images_, results_, objects_, options_); }

  std::vector<BopImage> images_;
  std::map<int, EvaluatedObject> objects_;
  std::vector<BopResult> results_;
  EvaluationOptions options_;
};

TEST_F(Evaluation, KnownErrorsAreReported) {
  detect(0, 1, at(0.003, 0.004, 0.8));
  detect(1, 1, at(0, 0, 0.8) * Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitZ()));
  detect(2, 1, at(0.03, 0, 0.8));
  detect(1, 2, at(0.2, 0, 0.8) * Eigen::AngleAxisd(2.0, Eigen::Vector3d::UnitZ()));
  const EvaluationReport r = report();
  ASSERT_EQ(4U, r.instances.size());
  EXPECT_NEAR(0.5, r.instances[0].translation_cm, 1e-9);
  EXPECT_NEAR(0, r.instances[0].rotation_deg, 1e-6);
  EXPECT_NEAR(5, *r.instances[0].add_mm, 1e-6);
  EXPECT_NEAR(0.2 * 57.29577951, r.instances[1].rotation_deg, 1e-6);
  EXPECT_NEAR(0, r.instances[1].translation_cm, 1e-9);
  const ObjectReport& one = r.objects.at(1);
  EXPECT_EQ(3, one.instances);
  EXPECT_EQ(3, one.found);
  EXPECT_EQ(2, one.right);
  EXPECT_NEAR(2.0 / 3, one.share_right(), 1e-12);
  EXPECT_NEAR(2.0 / 3, one.share_translation, 1e-12);
  EXPECT_NEAR(1, one.share_rotation, 1e-12);
  EXPECT_NEAR(0.5, one.median_translation_cm, 1e-9);
  EXPECT_NEAR(2.0 / 3, *one.add_recall, 1e-12) << "30 mm is more than a tenth of 200 mm";
  EXPECT_NEAR(2.0 / 3, one.precision(), 1e-12);
  const ObjectReport& two = r.objects.at(2);
  EXPECT_EQ(1, two.right) << "the turn about its axis does not count";
  EXPECT_NEAR(0, two.median_rotation_deg, 1e-6);
  EXPECT_EQ(4, r.total.instances);
  EXPECT_EQ(3, r.total.right);
  EXPECT_EQ(4, r.images);
  EXPECT_EQ(0.25, r.mean_seconds);
}

TEST_F(Evaluation, WhatIsNotFoundCountsAgainstTheShareNotTheMedian) {
  detect(0, 1, at(0, 0, 0.8));
  const EvaluationReport r = report();
  EXPECT_EQ(1, r.objects.at(1).found);
  EXPECT_NEAR(1.0 / 3, r.objects.at(1).share_right(), 1e-12);
  EXPECT_EQ(0, r.objects.at(1).median_translation_cm);
  EXPECT_FALSE(r.instances[1].found);
  EXPECT_EQ(0, r.objects.at(2).found);
}

TEST_F(Evaluation, DetectionsWhereTheObjectIsNotAreFalse) {
  detect(3, 1, at(0, 0, 0.8));
  detect(3, 1, at(0.1, 0, 0.8));
  detect(0, 2, at(0, 0, 0.8));
  const EvaluationReport r = report();
  EXPECT_EQ(1, r.objects.at(1).false_images);
  EXPECT_EQ(2, r.objects.at(1).false_detections);
  EXPECT_EQ(3, r.objects.at(2).false_images);
  EXPECT_EQ(1, r.objects.at(2).false_detections);
  EXPECT_EQ(0, r.objects.at(1).precision());
  EXPECT_EQ(0, *r.objects.at(1).average_precision);
}

TEST_F(Evaluation, TheBestScoredDetectionTakesTheNearestFreeObject) {
  images_[0].ground_truth.push_back({1, at(0.3, 0, 0.8), std::nullopt, std::nullopt});
  // The weaker detection lies exactly on the first object, but the stronger one takes it first.
  detect(0, 1, at(0.001, 0, 0.8), 0.9);
  detect(0, 1, at(0, 0, 0.8), 0.4);
  detect(0, 1, at(0.3, 0.002, 0.8), 0.8);
  const EvaluationReport r = report();
  EXPECT_NEAR(0.1, r.instances[0].translation_cm, 1e-9);
  EXPECT_NEAR(0.2, r.instances[1].translation_cm, 1e-9);
  EXPECT_EQ(3, r.objects.at(1).detections);
  EXPECT_NEAR(2.0 / 3, r.objects.at(1).precision(), 1e-12);
  // AP: two hits, then the duplicate, of 4 objects.
  EXPECT_NEAR(0.5, *r.objects.at(1).average_precision, 1e-12);
}

TEST_F(Evaluation, IgnoredInstancesAreNeitherHitsNorMisses) {
  options_.min_visible = 0.6;  // image 2: 0.4
  detect(0, 1, at(0, 0, 0.8));
  detect(1, 1, at(0, 0, 0.8));
  detect(2, 1, at(0.2, 0, 0.8));
  const EvaluationReport r = report();
  EXPECT_EQ(2, r.objects.at(1).instances);
  EXPECT_EQ(2, r.objects.at(1).detections);
  EXPECT_EQ(1, r.objects.at(1).precision());
}

TEST_F(Evaluation, UprightMeansItsUpAlongTheTables) {
  options_.upright_only = true;
  // The mesh's up in the camera: image 0 along the table's, image 1 tilted by 20 deg, image 2 has no table.
  const Eigen::Vector3d up(0, -0.6, -0.8);
  for (BopImage& image : images_) image.table = TableGeometry{up, 0.7};
  images_[2].table.reset();
  const Eigen::Matrix3d standing = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), up).matrix();
  images_[0].ground_truth[0].camera_from_mesh.linear() = standing;
  images_[1].ground_truth[0].camera_from_mesh.linear() =
      Eigen::AngleAxisd(0.35, Eigen::Vector3d::UnitX()) * standing;
  images_[2].ground_truth[0].camera_from_mesh.linear() = standing;
  EXPECT_EQ(1, report().objects.at(1).instances);
  options_.upright_tolerance_deg = 25;
  EXPECT_EQ(2, report().objects.at(1).instances);
}

TEST_F(Evaluation, StrictLimitsAndTurntableErrors) {
  detect(0, 1, at(0.004, 0, 0.8) * Eigen::AngleAxisd(-0.05, Eigen::Vector3d::UnitZ()));
  detect(1, 1, at(0, 0, 0.8) * Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitX()));
  detect(1, 2, at(0.2, 0, 0.8));
  const EvaluationReport r = report();
  EXPECT_TRUE(r.instances[0].strict);
  EXPECT_NEAR(-0.05 * 57.29577951, *r.instances[0].turntable_deg, 1e-6);
  EXPECT_TRUE(r.instances[1].right);
  EXPECT_FALSE(r.instances[1].strict) << "11.5 deg";
  EXPECT_NEAR(0, *r.instances[1].turntable_deg, 1e-6) << "a tilt is no turn";
  EXPECT_FALSE(r.instances[2].turntable_deg.has_value());
  EXPECT_NEAR(1.0 / 3, r.objects.at(1).share_strict(), 1e-12);
}

TEST_F(Evaluation, BopRecallsAreMeansOverTheirThresholds) {
  // 23 mm of 200 mm = 11.5 %: below 0.15 .. 0.50, 8 of 10. At 0.8 m and f 500 at least 14.375 px: the nearest
  // points are at 0.8 m: below 15, 20, .. 50, 8 of 10.
  detect(0, 1, at(0.023, 0, 0.8));
  const EvaluationReport r = report();
  EXPECT_NEAR(23, *r.instances[0].mssd_mm, 1e-6);
  EXPECT_NEAR(500 * 0.023 / 0.8, *r.instances[0].mspd_px, 1e-6);
  EXPECT_NEAR(0.8 / 3, *r.objects.at(1).ar_mssd, 1e-12) << "two of three are not found";
  EXPECT_NEAR(0.8 / 3, *r.objects.at(1).ar_mspd, 1e-12);
  EXPECT_FALSE(r.objects.at(1).ar_vsd.has_value());
  InstanceResult seen = r.instances[0];
  seen.vsd = {1, 0.32, 0.12, 0, 0, 0, 0, 0, 0, 0};
  // Limits 0.05, 0.10: 7 tolerances below; 0.15 .. 0.30: 8; 0.35 .. 0.50: 9.
  EXPECT_NEAR((2 * 0.7 + 4 * 0.8 + 4 * 0.9) / 10, recall_vsd({&seen}), 1e-12);
}

TEST_F(Evaluation, ScoresThatAreProbabilitiesAreCheckedAsSuch) {
  detect(0, 1, at(0, 0, 0.8), 0.9);
  detect(1, 1, at(0.1, 0, 0.8), 0.7);
  detect(3, 1, at(0, 0, 0.8), 0.2);
  const EvaluationReport r = report();
  ASSERT_TRUE(r.total.calibrated.has_value());
  EXPECT_NEAR((0.1 + 0.7 + 0.2) / 3, r.total.calibrated->expected_error, 1e-12);
  ASSERT_EQ(1U, r.false_answers.size());
  EXPECT_EQ(3, r.false_answers[0].image_id);
}

TEST_F(Evaluation, ConfusionTellsAnywhereFromInside) {
  // Image 0 holds object 1; object 2's detector answers on it. Image 1 holds both; 2's detector finds its
  // own and also something far off. Image 2: object 1 found.
  detect(0, 2, at(0, 0, 0.8));
  detect(1, 2, at(0.2, 0, 0.8), 0.9);
  detect(1, 2, at(-0.3, 0, 0.8), 0.5);
  detect(2, 1, at(0, 0, 0.8));
  const Confusion c = report().confusion;
  EXPECT_EQ(3, c.images.at(1));
  EXPECT_EQ(1, c.images.at(2));
  EXPECT_EQ(2, c.anywhere.at(1).at(2)) << "images 0 and 1";
  EXPECT_EQ(1, c.inside.at(1).at(2)) << "image 0";
  EXPECT_EQ(1, c.anywhere.at(1).at(1)) << "image 2";
  EXPECT_EQ(1, c.inside.at(2).at(2));
  EXPECT_EQ(0U, c.anywhere.at(2).count(1));
}

TEST_F(Evaluation, ResultsOfAnotherDataSetAreRefused) {
  detect(17, 1, at(0, 0, 0.8));
  EXPECT_THROW(report(), InputError);
}

}  // namespace
}  // namespace sextant
