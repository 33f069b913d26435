// SPDX-License-Identifier: Apache-2.0
#include "offline/render/renderer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <thread>

#include "runtime/geometry/pose_mapping.h"

namespace sextant {
namespace {

const PinholeCamera kCamera{640, 480, 525, 319.5, 239.5};
const cv::Rect kWhole{0, 0, 640, 480};

/// A rectangle in the plane z = 0, corners at +-w/2, +-h/2.
Mesh rectangle(float w, float h) {
  Mesh m;
  m.vertices = {{-w / 2, -h / 2, 0}, {w / 2, -h / 2, 0}, {w / 2, h / 2, 0}, {-w / 2, h / 2, 0}};
  m.normals.assign(4, {0, 0, 1});
  m.colours.assign(4, {1, 1, 1});
  m.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  MeshPart part;
  part.triangles = {{0, 1, 2}, {0, 2, 3}};
  m.parts = {part};
  return m;
}

// Depth against the analytic distance along the ray: the surface is a plane n.X = d.
TEST(Renderer, RayDepthIsExactToATenthOfAMillimetreAtOneMetre) {
  Renderer renderer;
  const int mesh = renderer.upload(rectangle(3, 3));
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  double worst = 0;
  for (int i = 0; i < 20; ++i) {
    RigidTransform t = RigidTransform::Identity();
    t.translation() = Eigen::Vector3d(0.1 * unit(random), 0.1 * unit(random), 1.0);
    t.rotate(Eigen::AngleAxisd(unit(random), Eigen::Vector3d(unit(random), unit(random), 0.1).normalized()));
    const RenderedView view = renderer.render(kCamera, kWhole, {{mesh, t}}, {}, {0, 0, 0});
    const Eigen::Vector3d n = t.linear().col(2);
    int seen = 0;
    for (int y = 0; y < 480; y += 7) {
      for (int x = 0; x < 640; x += 7) {
        const float d = view.ray_depth_m.at<float>(y, x);
        if (d == 0) continue;
        const double exact = n.dot(t.translation()) / n.dot(kCamera.ray(x, y));
        if (exact > 1.5) continue;
        worst = std::max(worst, std::abs(d - exact));
        ++seen;
      }
    }
    EXPECT_GT(seen, 100);
  }
  RecordProperty("worst_depth_error_mm", std::to_string(worst * 1e3));
  std::printf("worst depth error: %.5f mm\n", worst * 1e3);
  EXPECT_LT(worst, 1e-4);
}

TEST(Renderer, DrawsWhereTheCameraProjects) {
  Renderer renderer;
  const int mesh = renderer.upload(rectangle(0.02F, 0.02F));
  for (const Eigen::Vector2d& pixel :
       {Eigen::Vector2d(100, 50), Eigen::Vector2d(600, 400), Eigen::Vector2d(320, 240)}) {
    RigidTransform t = RigidTransform::Identity();
    t.translation() = kCamera.ray(pixel.x(), pixel.y()) * 1.0;
    const RenderedView view = renderer.render(kCamera, kWhole, {{mesh, t}}, {}, {0, 0, 0});
    double sx = 0;
    double sy = 0;
    int n = 0;
    for (int y = 0; y < 480; ++y) {
      for (int x = 0; x < 640; ++x) {
        if (view.item.at<short>(y, x) == 0) {
          sx += x;
          sy += y;
          ++n;
        }
      }
    }
    ASSERT_GT(n, 50);
    EXPECT_NEAR(sx / n, pixel.x(), 0.6);
    EXPECT_NEAR(sy / n, pixel.y(), 0.6);
  }
}

TEST(Renderer, AWindowIsACutOfTheWholeImage) {
  Renderer renderer;
  const int mesh = renderer.upload(rectangle(0.5F, 0.3F));
  const RigidTransform t = transform_from_pose(kCamera, {300, 200, 1.0, 0.2, -1.0, 0.4});
  const cv::Rect window(220, 130, 150, 140);
  const RenderedView whole = renderer.render(kCamera, kWhole, {{mesh, t}}, {}, {9, 9, 9});
  const RenderedView part = renderer.render(kCamera, window, {{mesh, t}}, {}, {9, 9, 9});
  const cv::Mat cut = whole.ray_depth_m(window);
  int differ = 0;
  for (int y = 0; y < window.height; ++y) {
    for (int x = 0; x < window.width; ++x) {
      if (std::abs(cut.at<float>(y, x) - part.ray_depth_m.at<float>(y, x)) > 1e-5) ++differ;
    }
  }
  EXPECT_LT(differ, 3);  // a pixel centre may lie on the silhouette itself
}

TEST(Renderer, NearerItemsHideFartherOnes) {
  Renderer renderer;
  const int mesh = renderer.upload(rectangle(0.2F, 0.2F));
  RigidTransform near_one = RigidTransform::Identity();
  near_one.translation().z() = 1;
  RigidTransform far_one = near_one;
  far_one.translation().z() = 2;
  const RenderedView view =
      renderer.render(kCamera, kWhole, {{mesh, far_one}, {mesh, near_one}}, {}, {0, 0, 0});
  EXPECT_EQ(view.item.at<short>(240, 320), 1);
  EXPECT_NEAR(view.ray_depth_m.at<float>(240, 320), 1, 1e-3);
  EXPECT_EQ(view.item.at<short>(5, 5), -1);
}

TEST(Renderer, TexturesStandUpright) {
  Mesh m = rectangle(0.4F, 0.4F);
  cv::Mat image(64, 64, CV_8UC3, cv::Scalar(255, 0, 0));
  image.rowRange(32, 64).setTo(cv::Scalar(0, 0, 255));  // top red, bottom blue
  m.textures = {image};
  m.parts[0].texture = 0;
  Renderer renderer;
  const int mesh = renderer.upload(m);
  RigidTransform t = RigidTransform::Identity();
  t.translation().z() = 1;
  t.linear() << 1, 0, 0, 0, -1, 0, 0, 0, -1;  // mesh y up in the image
  const RenderedView view = renderer.render(kCamera, kWhole, {{mesh, t}}, {{0, 0, 0}, 1.0}, {0, 0, 0});
  EXPECT_GT(view.colour.at<cv::Vec3b>(200, 320)[0], 200);
  EXPECT_GT(view.colour.at<cv::Vec3b>(280, 320)[2], 200);
}

TEST(Renderer, FillLightsAddAndTheMainOneCanBeSwitchedOff) {
  Renderer renderer;
  const int mesh = renderer.upload(rectangle(3, 3));
  RigidTransform t = RigidTransform::Identity();
  t.translation().z() = 1;
  const auto brightness = [&](const Light& light) {
    return static_cast<int>(
        renderer.render_colour(kCamera, kWhole, {{mesh, t}}, light, {0, 0, 0}).at<cv::Vec3b>(240, 320)[0]);
  };
  // Facing the camera, lit from the camera: ambient + (1 - ambient) * strength.
  Light light;
  light.ambient = 0.25;
  EXPECT_NEAR(255, brightness(light), 1);
  light.strength = 0;
  EXPECT_NEAR(0.25 * 255, brightness(light), 1);
  light.fills = {{{0, 0, 0}, 0.2}, {{0, 0, 0}, 0.1}};
  EXPECT_NEAR(0.55 * 255, brightness(light), 1);
}

TEST(Renderer, GlossMakesAHighlightWhereTheLightIsMirrored) {
  Renderer renderer;
  Mesh dark = rectangle(3, 3);
  dark.parts[0].diffuse = {0.2F, 0.2F, 0.2F};
  const int mesh = renderer.upload(dark);
  RigidTransform t = RigidTransform::Identity();
  t.translation().z() = 1;
  const cv::Mat matt = renderer.render_colour(kCamera, kWhole, {{mesh, t}}, {}, {0, 0, 0});
  const cv::Mat shiny = renderer.render_colour(kCamera, kWhole, {{mesh, t, 0.5}}, {}, {0, 0, 0});
  EXPECT_NEAR(0.5 * 255, shiny.at<cv::Vec3b>(240, 320)[0] - matt.at<cv::Vec3b>(240, 320)[0], 3);
  EXPECT_NEAR(0, shiny.at<cv::Vec3b>(5, 5)[0] - matt.at<cv::Vec3b>(5, 5)[0], 12)
      << "far from the mirror image";
}

TEST(Renderer, GeometryAloneIsThatOfTheWholePicture) {
  Renderer renderer;
  const int mesh = renderer.upload(rectangle(0.5F, 0.3F));
  const RigidTransform t = transform_from_pose(kCamera, {300, 200, 1.0, 0.2, -1.0, 0.4});
  const RenderedView whole = renderer.render(kCamera, kWhole, {{mesh, t}}, {}, {9, 9, 9});
  const RenderedView alone = renderer.render_geometry(kCamera, kWhole, {{mesh, t}});
  EXPECT_EQ(0, cv::countNonZero(whole.ray_depth_m != alone.ray_depth_m));
  EXPECT_EQ(0, cv::countNonZero(whole.item != alone.item));
  EXPECT_TRUE(alone.colour.empty());
}

TEST(Renderer, TheSameInAnyThread) {
  const RigidTransform t = transform_from_pose(kCamera, {300, 200, 1.0, 0.2, -1.0, 0.4});
  auto draw = [&t] {
    Renderer renderer;
    return renderer.render(kCamera, kWhole, {{renderer.upload(rectangle(0.5F, 0.3F)), t}}, {}, {9, 9, 9})
        .ray_depth_m;
  };
  const cv::Mat here = draw();
  cv::Mat a;
  cv::Mat b;
  std::thread first([&] { a = draw(); });
  std::thread second([&] { b = draw(); });
  first.join();
  second.join();
  EXPECT_EQ(cv::countNonZero(here != a), 0);
  EXPECT_EQ(cv::countNonZero(here != b), 0);
}

}  // namespace
}  // namespace sextant
