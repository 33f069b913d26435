// SPDX-License-Identifier: Apache-2.0
// VSD over rendered images: the truth has none, another place has all.
#include "offline/evaluate/vsd_evaluation.h"

#include <gtest/gtest.h>

#include "offline/evaluate/point_error.h"
#include "offline/synthesize/synthesize.h"
#include "tests/support/simple_objects.h"
#include "tests/support/temporary_folder.h"

namespace sextant {
namespace {

TEST(VsdEvaluation, OfTheTruthIsZeroAndOfAnotherPlaceOne) {
  const TemporaryFolder folder;
  SynthesisOptions options;
  options.output = folder.path();
  options.images = 2;
  options.sensor = "none";
  options.scene.camera = {320, 240, 262.5, 159.5, 119.5};
  options.scene.occlusion = {0, 0.3};
  const StandingObject box = box_object(0.04, 0.06, 0.09);
  synthesize_dataset({{5, box}}, {}, options, {});
  const BopDataset dataset = open_bop_dataset(folder.path(), "test");

  std::map<int, EvaluatedObject> objects;
  objects[5].diameter_m = 2 * box.bounding_radius_m;
  objects[5].points = thinned(box.mesh.vertices, 100);
  std::vector<BopResult> results;
  for (const BopImage& image : dataset.images) {
    BopResult result{1, image.image_id, 5, 0.9, image.ground_truth.at(0).camera_from_mesh, -1};
    if (image.image_id == 1) result.camera_from_mesh.pretranslate(Eigen::Vector3d(0, 0, -0.25));
    results.push_back(result);
  }
  EvaluationReport report = evaluate(dataset.images, results, objects, {});
  std::size_t done = 0;
  add_vsd(report, dataset.images, objects, {{5, box.mesh}}, [&](std::size_t d, std::size_t) { done = d; });
  EXPECT_EQ(2U, done);
  ASSERT_EQ(2U, report.instances.size());
  ASSERT_EQ(10U, report.instances[0].vsd.size());
  for (const double e : report.instances[0].vsd) EXPECT_LT(e, 0.02);
  for (const double e : report.instances[1].vsd) EXPECT_GT(e, 0.5);
  ASSERT_TRUE(report.objects.at(5).ar_vsd.has_value());
  EXPECT_NEAR(0.5, *report.objects.at(5).ar_vsd, 1e-9);
  EXPECT_TRUE(report.total.average_recall().has_value());
}

}  // namespace
}  // namespace sextant
