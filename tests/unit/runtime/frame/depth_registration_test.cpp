// SPDX-License-Identifier: Apache-2.0
// Registration against a scene whose depth is known in closed form from any camera: a table and boxes that
// face it. What the colour camera should see is computed per pixel, not by the code under test.
#include "runtime/frame/depth_registration.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "runtime/base/error.h"

namespace sextant {
namespace {

CameraModel camera(int width, int height, double fx, double fy) {
  CameraModel c;
  c.width = width;
  c.height = height;
  c.fx = fx;
  c.fy = fy;
  c.cx = 0.5 * width - 3;
  c.cy = 0.5 * height + 2;
  return c;
}

/// A rectangle in a plane of constant x, y or z of the world.
struct Panel {
  int axis;
  double at;
  double lo[2], hi[2];  ///< of the two other axes, ascending
};

/// World: z up, the table at z = 0; the camera looks at it from above.
struct Scene {
  std::vector<Panel> panels{{2, 0, {-3, -3}, {3, 3}}};

  void add_box(double x, double y, double w, double d, double h) {
    panels.push_back({2, h, {x, y}, {x + w, y + d}});
    panels.push_back({1, y, {x, 0}, {x + w, h}});
    panels.push_back({0, x, {y, 0}, {y + d, h}});
    panels.push_back({0, x + w, {y, 0}, {y + d, h}});
  }

  /// Axial depth along the camera's ray through a tangent, infinity where nothing is hit.
  double axial(const RigidTransform& world_from_camera, const Eigen::Vector2d& tangent) const {
    const Eigen::Vector3d o = world_from_camera.translation();
    const Eigen::Vector3d d = world_from_camera.linear() * Eigen::Vector3d(tangent.x(), tangent.y(), 1);
    double best = std::numeric_limits<double>::infinity();
    for (const Panel& p : panels) {
      const double t = (p.at - o[p.axis]) / d[p.axis];
      if (!(t > 0.05) || t >= best) continue;
      const Eigen::Vector3d hit = o + t * d;
      bool inside = true;
      for (int k = 0, j = 0; k < 3; ++k) {
        if (k == p.axis) continue;
        inside = inside && hit[k] >= p.lo[j] && hit[k] <= p.hi[j];
        ++j;
      }
      if (inside) best = t;
    }
    return best;
  }

  cv::Mat seen(const CameraModel& c, const RigidTransform& world_from_camera) const {
    cv::Mat depth = cv::Mat::zeros(c.height, c.width, CV_32FC1);
    for (int y = 0; y < c.height; ++y) {
      for (int x = 0; x < c.width; ++x) {
        const double z = axial(world_from_camera, c.undistorted_tangent(x, y));
        if (std::isfinite(z) && z < 5) depth.at<float>(y, x) = static_cast<float>(z);
      }
    }
    return depth;
  }
};

/// 0.7 m above the table, 40 deg down.
RigidTransform world_from_colour() {
  RigidTransform t = RigidTransform::Identity();
  const double pitch = 0.7;
  t.linear().col(0) = Eigen::Vector3d(1, 0, 0);
  t.linear().col(2) = Eigen::Vector3d(0, std::cos(pitch), -std::sin(pitch));
  t.linear().col(1) = t.linear().col(2).cross(t.linear().col(0));
  t.translation() = Eigen::Vector3d(0, -0.8, 0.7);
  return t;
}

RigidTransform colour_from_depth(double baseline) {
  RigidTransform t = RigidTransform::Identity();
  t.linear() = (Eigen::AngleAxisd(0.01, Eigen::Vector3d::UnitY()) *
                Eigen::AngleAxisd(-0.015, Eigen::Vector3d::UnitX()))
                   .toRotationMatrix();
  t.translation() = Eigen::Vector3d(-baseline, 0.004, 0.002);
  return t;
}

Scene boxes() {
  Scene s;
  s.add_box(-0.2, -0.1, 0.12, 0.08, 0.2);
  s.add_box(0.08, 0.05, 0.1, 0.1, 0.12);
  return s;
}

TEST(DepthRegistration, SameCameraChangesNothing) {
  const CameraModel c = camera(160, 120, 150, 150);
  cv::Mat depth = boxes().seen(c, world_from_colour());
  depth.at<float>(60, 80) = 0;
  depth.at<float>(61, 90) = std::numeric_limits<float>::quiet_NaN();
  depth.at<float>(62, 95) = -1;
  DepthRegistration registration(c, c, RigidTransform::Identity(), "test");
  const cv::Mat out = registration.registered(depth);
  int same = 0;
  for (int y = 0; y < c.height; ++y) {
    for (int x = 0; x < c.width; ++x) {
      const float in = depth.at<float>(y, x);
      const float expected = in > 0 ? in : 0.0F;
      if (expected == 0) {
        EXPECT_EQ(out.at<float>(y, x), 0) << x << ' ' << y;
      } else {
        EXPECT_EQ(out.at<float>(y, x), expected) << x << ' ' << y;
        ++same;
      }
    }
  }
  EXPECT_GT(same, 15000);
}

struct Rig {
  CameraModel depth, colour;
};

/// Every registered pixel against the surfaces that the colour camera sees within a pixel around it.
void expect_matches_scene(const Rig& rig) {
  const Scene scene = boxes();
  const RigidTransform colour_from_depth_ = colour_from_depth(0.04);
  const RigidTransform world = world_from_colour();
  const cv::Mat depth = scene.seen(rig.depth, world * colour_from_depth_);
  DepthRegistration registration(rig.depth, rig.colour, colour_from_depth_, "test");
  const cv::Mat out = registration.registered(depth);
  const RigidTransform depth_from_world = (world * colour_from_depth_).inverse();
  const double margin = 1.0 + rig.colour.fx / rig.depth.fx;  // pixels: half a depth pixel and rounding
  int checked = 0;
  int missing = 0;
  int wrong = 0;
  for (int y = 12; y < rig.colour.height - 12; ++y) {
    for (int x = 12; x < rig.colour.width - 12; ++x) {
      double lo = std::numeric_limits<double>::infinity();
      double hi = 0;
      for (const double dy : {-margin, 0.0, margin}) {
        for (const double dx : {-margin, 0.0, margin}) {
          const double z = scene.axial(world, rig.colour.undistorted_tangent(x + dx, y + dy));
          lo = std::min(lo, z);
          hi = std::max(hi, z);
        }
      }
      const Eigen::Vector2d tangent = rig.colour.undistorted_tangent(x, y);
      const double z = scene.axial(world, tangent);
      const Eigen::Vector3d point = world * Eigen::Vector3d(z * tangent.x(), z * tangent.y(), z);
      const Eigen::Vector3d in_depth = depth_from_world * point;
      const Eigen::Vector2d at =
          rig.depth.distorted_pixel({in_depth.x() / in_depth.z(), in_depth.y() / in_depth.z()});
      const bool in_view =
          at.x() > 2 && at.y() > 2 && at.x() < rig.depth.width - 3 && at.y() < rig.depth.height - 3;
      const float got = out.at<float>(y, x);
      if (got > 0) {
        if (got < lo - 0.004 || got > hi + 0.004) ++wrong;
        ++checked;
      } else if (in_view && hi - lo < 0.02) {
        // Smooth surroundings: missing only where the depth camera's view of this point is blocked.
        const double seen = scene.axial(world * colour_from_depth_,
                                        {in_depth.x() / in_depth.z(), in_depth.y() / in_depth.z()});
        if (seen > in_depth.z() - 0.02) ++missing;
      }
    }
  }
  EXPECT_GT(checked, rig.colour.width * rig.colour.height / 2);
  // Points at the rim of an occlusion shadow may show the background that a wrong half pixel reaches.
  EXPECT_LE(wrong, checked / 500);
  EXPECT_LE(missing, checked / 1000);
}

TEST(DepthRegistration, ShowsWhatTheColourCameraSees) {
  expect_matches_scene({camera(320, 240, 290, 290), camera(320, 240, 262, 262)});
}
TEST(DepthRegistration, FillsNoCracksWhenColourIsFiner) {
  expect_matches_scene({camera(160, 120, 145, 140), camera(400, 300, 330, 345)});
}
TEST(DepthRegistration, KeepsTheNearestWhenColourIsCoarser) {
  expect_matches_scene({camera(424, 320, 380, 380), camera(200, 150, 165, 165)});
}
TEST(DepthRegistration, OneSampleStandsForManyWhenColourIsMuchCoarser) {
  expect_matches_scene({camera(640, 480, 580, 580), camera(160, 120, 131, 131)});
  expect_matches_scene({camera(640, 480, 580, 570), camera(320, 240, 290, 288)});
}
TEST(DepthRegistration, UndoesDistortionOfBoth) {
  Rig rig{camera(320, 240, 290, 290), camera(320, 240, 262, 270)};
  rig.depth.distortion = {0.08, -0.05, 0.001, -0.002, 0};
  rig.colour.distortion = {-0.1, 0.06, -0.001, 0.001, 0};
  expect_matches_scene(rig);
}

// Noise moves neighbours against each other: a splat of fixed size would show cracks.
TEST(DepthRegistration, NoisySurfacesHaveNoCracksAndNoBias) {
  const CameraModel depth = camera(320, 240, 290, 290);
  const CameraModel colour = camera(320, 240, 290, 290);
  Scene scene;
  const RigidTransform offset = colour_from_depth(0.06);
  cv::Mat seen = scene.seen(depth, world_from_colour() * offset);
  DepthRegistration registration(depth, colour, offset, "test");
  // The same pixels without noise: what remains is what noise does, not where samples lie.
  const cv::Mat clean = registration.registered(seen);
  std::mt19937 random(5);
  std::normal_distribution<float> noise(0, 0.002F);
  for (int y = 0; y < seen.rows; ++y) {
    for (int x = 0; x < seen.cols; ++x) seen.at<float>(y, x) += noise(random);
  }
  const cv::Mat out = registration.registered(seen);
  double sum = 0;
  int count = 0;
  int missing = 0;
  for (int y = 20; y < 220; ++y) {
    for (int x = 40; x < 280; ++x) {
      if (out.at<float>(y, x) == 0) {
        ++missing;
      } else {
        sum += out.at<float>(y, x) - clean.at<float>(y, x);
        ++count;
      }
    }
  }
  EXPECT_LT(missing, count / 500);
  EXPECT_LT(std::abs(sum / count), 0.0003);
}

TEST(DepthRegistration, HolesStayHoles) {
  const CameraModel c = camera(320, 240, 290, 290);
  cv::Mat depth(c.height, c.width, CV_32FC1, cv::Scalar(0.9));
  depth(cv::Rect(100, 80, 20, 15)).setTo(0);
  for (int x = 40; x < 60; x += 2) depth.at<float>(50, x) = 0;  // single pixels
  RigidTransform shift = RigidTransform::Identity();
  // 10 pixels to the right at this depth.
  shift.translation().x() = 10 * 0.9 / 290;
  DepthRegistration registration(c, c, shift, "test");
  const cv::Mat out = registration.registered(depth);
  int holes = 0;
  for (int y = 20; y < 200; ++y) {
    for (int x = 30; x < 300; ++x) holes += out.at<float>(y, x) == 0 ? 1 : 0;
  }
  EXPECT_NEAR(holes, 20 * 15 + 10, 6);
  EXPECT_EQ(out.at<float>(85, 115), 0);
  EXPECT_EQ(out.at<float>(50, 54), 0);
}

TEST(DepthRegistration, TheNearestSurfaceWins) {
  const CameraModel c = camera(320, 240, 290, 290);
  cv::Mat depth(c.height, c.width, CV_32FC1, cv::Scalar(1.5));
  depth(cv::Rect(100, 80, 60, 60)).setTo(0.6);
  RigidTransform shift = RigidTransform::Identity();
  shift.translation().x() = 0.06;
  DepthRegistration registration(c, c, shift, "test");
  const cv::Mat out = registration.registered(depth);
  // The panel moves by 29 pixels, the background by 11.6: the panel covers it.
  for (int x = 131; x < 187; ++x) EXPECT_NEAR(out.at<float>(100, x), 0.6, 1e-6) << x;
  // What the panel hid from the depth camera is unknown.
  for (int x = 114; x < 128; ++x) EXPECT_EQ(out.at<float>(100, x), 0) << x;
  EXPECT_NEAR(out.at<float>(100, 105), 1.5, 1e-6);
}

TEST(DepthRegistration, RefusesNonsense) {
  const CameraModel c = camera(160, 120, 150, 150);
  CameraModel bad = c;
  bad.fx = 0;
  EXPECT_THROW(DepthRegistration(bad, c, RigidTransform::Identity(), "x"), InputError);
  EXPECT_THROW(DepthRegistration(c, bad, RigidTransform::Identity(), "x"), InputError);
  RigidTransform t = RigidTransform::Identity();
  t.linear() *= 1.1;
  EXPECT_THROW(DepthRegistration(c, c, t, "x"), InputError);
  t = RigidTransform::Identity();
  t.translation().x() = 25;  // millimetres taken for metres
  EXPECT_THROW(DepthRegistration(c, c, t, "x"), InputError);
  DepthRegistration good(c, c, RigidTransform::Identity(), "x");
  EXPECT_THROW(good.registered(cv::Mat(120, 161, CV_32FC1)), InputError);
  EXPECT_THROW(good.registered(cv::Mat(120, 160, CV_16UC1)), InputError);
}

}  // namespace
}  // namespace sextant
