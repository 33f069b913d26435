// SPDX-License-Identifier: Apache-2.0
#include "offline/report/model_sheet/contact_sheet.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <set>

#include "offline/report/model_sheet/shaded_mesh.h"
#include "runtime/geometry/pose_mapping.h"
#include "synthetic_model.h"

namespace sextant {
namespace {

bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && cv::norm(a, b, cv::NORM_INF) == 0;
}

TEST(BinsOfSheet, AreEvenlySpread) {
  EXPECT_EQ(bins_of_sheet(3, 24), (std::vector<std::size_t>{0, 1, 2}));
  EXPECT_EQ(bins_of_sheet(100, 1), (std::vector<std::size_t>{0}));
  EXPECT_TRUE(bins_of_sheet(0, 5).empty());
  for (std::size_t count = 1; count < 60; ++count) {
    for (std::size_t most = 1; most < 60; ++most) {
      const auto bins = bins_of_sheet(count, most);
      ASSERT_EQ(bins.size(), std::min(count, most));
      EXPECT_LT(bins.back(), count);
      for (std::size_t i = 1; i < bins.size(); ++i) {
        EXPECT_GT(bins[i], bins[i - 1]);
        EXPECT_LE(bins[i] - bins[i - 1], 2 * count / bins.size() + 1);
      }
    }
  }
}

TEST(BinsOfSheet, DoNotFallIntoStepWithTheOrderOfBins) {
  // 360 bins as rz x 5 elevations x 4 rolls: 24 of them must show every elevation and every roll.
  std::set<std::size_t> rolls;
  std::set<std::size_t> elevations;
  for (const std::size_t i : bins_of_sheet(360, 24)) {
    rolls.insert(i % 4);
    elevations.insert(i / 4 % 5);
  }
  EXPECT_EQ(rolls.size(), 4U);
  EXPECT_EQ(elevations.size(), 5U);
}

// The painted silhouette against a ray through each pixel: the box is convex, so a pixel is painted exactly
// if its ray meets the box. Pixels on the outline may differ.
TEST(ShadedMesh, PaintsTheSilhouette) {
  const ObjectModel model = test::make_box_model(1, 1, 1);
  const PinholeCamera camera{200, 200, 500, 99.5, 99.5};
  const Pose6 pose{90, 110, 0.8, 0.1, -0.7, 0.6};
  const RigidTransform t = transform_from_pose(camera, pose);
  cv::Mat image(200, 200, CV_8UC3, cv::Scalar::all(0));
  draw_shaded_mesh(model.mesh, camera, t, image);
  const Eigen::Vector3d half = model.mesh.vertices.back().cast<double>();
  const Eigen::Vector3d origin = t.inverse() * Eigen::Vector3d::Zero();
  int differ = 0;
  int inside = 0;
  for (int y = 0; y < 200; ++y) {
    for (int x = 0; x < 200; ++x) {
      const Eigen::Vector3d direction = t.linear().transpose() * camera.ray(x, y);
      const Eigen::Array3d a = (-half - origin).array() / direction.array();
      const Eigen::Array3d b = (half - origin).array() / direction.array();
      const bool hit = a.min(b).maxCoeff() < a.max(b).minCoeff();
      const bool painted = image.at<cv::Vec3b>(y, x)[0] != 0;
      inside += hit;
      differ += hit != painted;
    }
  }
  EXPECT_GT(inside, 5000);
  EXPECT_LE(differ, 4);  // rounding on the outline
}

TEST(ShadedMesh, NearerFacesCoverFartherOnes) {
  ModelMesh mesh;
  // A small square before a large slanted one, listed first.
  mesh.vertices = {{-0.1F, 0, -0.1F},    {0.1F, 0, -0.1F},    {0.1F, 0, 0.1F},    {-0.1F, 0, 0.1F},
                   {-0.3F, 0.2F, -0.3F}, {0.3F, 0.9F, -0.3F}, {0.3F, 0.9F, 0.3F}, {-0.3F, 0.2F, 0.3F}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}};
  const PinholeCamera camera{100, 100, 100, 49.5, 49.5};
  cv::Mat image(100, 100, CV_8UC3, cv::Scalar::all(0));
  draw_shaded_mesh(mesh, camera, transform_from_pose(camera, {49.5, 49.5, 1, 0, 0, 0}), image);
  const int front = image.at<cv::Vec3b>(50, 50)[0];
  const int back = image.at<cv::Vec3b>(50, 36)[0];
  EXPECT_GT(front, 0);
  EXPECT_GT(back, 0);
  EXPECT_NE(front, back);
  // The same picture whatever the order.
  std::reverse(mesh.triangles.begin(), mesh.triangles.end());
  cv::Mat again(100, 100, CV_8UC3, cv::Scalar::all(0));
  draw_shaded_mesh(mesh, camera, transform_from_pose(camera, {49.5, 49.5, 1, 0, 0, 0}), again);
  EXPECT_TRUE(same(image, again));
}

TEST(ShadedMesh, LeavesOutWhatIsBehindTheCamera) {
  ModelMesh mesh;
  mesh.vertices = {{-1, -3, -1}, {1, -3, -1}, {0, 3, 1}};
  mesh.triangles = {{0, 1, 2}};
  const PinholeCamera camera{100, 100, 100, 49.5, 49.5};
  cv::Mat image(100, 100, CV_8UC3, cv::Scalar::all(0));
  draw_shaded_mesh(mesh, camera, transform_from_pose(camera, {49.5, 49.5, 1, 0, 0, 0}), image);
  EXPECT_EQ(cv::norm(image, cv::NORM_INF), 0);
}

TEST(ContactSheet, ShowsEachPartWhereItIsExpected) {
  const ObjectModel bare = [] {
    ObjectModel model = test::make_box_model(1, 1, 1);
    model.bins.resize(1);
    model.bins[0].visual.clear();
    model.bins[0].depth.clear();
    model.mesh = {};
    return model;
  }();
  ContactSheetOptions options;
  const cv::Mat empty = draw_contact_sheet(bare, options);

  // One horizontal edge, half a radius to the right: in the left panel, 0.22 of its width right of its
  // centre.
  ObjectModel with_edge = bare;
  VisualPart edge;
  edge.u[0] = static_cast<float>(bare.bounding_radius_m / 2);
  with_edge.bins[0].visual.push_back(edge);
  cv::Mat changed;
  cv::absdiff(draw_contact_sheet(with_edge, options), empty, changed);
  cv::cvtColor(changed, changed, cv::COLOR_RGB2GRAY);
  changed.rowRange(0, 64).setTo(0);  // the caption tells the number of parts
  const cv::Rect where = cv::boundingRect(changed);
  EXPECT_NEAR(where.x + where.width / 2.0, 8 + 240 * (0.5 + 0.22), 2);
  EXPECT_NEAR(where.y + where.height / 2.0, 64 + 120, 2);
  EXPECT_GT(where.width, 3 * where.height);

  // One depth part above the centre, in the right panel.
  ObjectModel with_depth = bare;
  DepthPart depth;
  depth.py = static_cast<float>(-bare.bounding_radius_m / 2);
  with_depth.bins[0].depth.push_back(depth);
  cv::absdiff(draw_contact_sheet(with_depth, options), empty, changed);
  cv::cvtColor(changed, changed, cv::COLOR_RGB2GRAY);
  changed.rowRange(0, 64).setTo(0);
  const cv::Rect dot = cv::boundingRect(changed);
  EXPECT_NEAR(dot.x + dot.width / 2.0, 8 + 240 + 120, 2);
  EXPECT_NEAR(dot.y + dot.height / 2.0, 64 + 240 * (0.5 - 0.22), 2);
}

TEST(ContactSheet, HasAsManyTilesAsAsked) {
  const ObjectModel model = test::make_box_model(18, 3, 1);  // 36 bins
  ContactSheetOptions options;
  options.panel_px = 64;
  options.max_bins = 4;
  const cv::Mat few = draw_contact_sheet(model, options);
  options.max_bins = 36;
  const cv::Mat all = draw_contact_sheet(model, options);
  EXPECT_EQ(all.type(), CV_8UC3);
  EXPECT_GT(all.total(), 4 * few.total() / 3);
  EXPECT_TRUE(same(all, draw_contact_sheet(model, options)));
}

// Parts and vertices at the limits of what a file may hold are drawn or left out, never fatal.
TEST(ContactSheet, DrawsAbsurdModels) {
  ObjectModel model = test::make_random_model(3, 20, 0.2, 1);
  for (ViewpointBin& bin : model.bins) {
    for (VisualPart& part : bin.visual) part.u[0] = 1200;
    for (DepthPart& part : bin.depth) part.py = -63;
  }
  for (auto& vertex : model.mesh.vertices) vertex *= 1.9F;
  model.bounding_radius_m = 1e-6;
  EXPECT_FALSE(draw_contact_sheet(model, {}).empty());
}

}  // namespace
}  // namespace sextant
