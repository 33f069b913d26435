// SPDX-License-Identifier: Apache-2.0
#include "offline/learn/training_view.h"

#include <cmath>

#include "runtime/features/edges.h"
#include "runtime/geometry/pose_mapping.h"
#include "runtime/search/lattice.h"

namespace sextant {
namespace {

/// Window around the projected bounding sphere: its tangent cone, stretched by the obliquity of the ray, and
/// a border for the filters.
cv::Rect window_around(const PinholeCamera& camera, const Pose6& pose, double radius_m) {
  constexpr int kBorder = 6;
  const double n = 1 / camera.ray(pose.x, pose.y).z();
  const double half = camera.focal * radius_m / std::sqrt(pose.z * pose.z - radius_m * radius_m) * n * n;
  const int side = 2 * (static_cast<int>(std::ceil(half)) + kBorder) + 1;
  return {static_cast<int>(std::lround(pose.x)) - side / 2, static_cast<int>(std::lround(pose.y)) - side / 2,
          side, side};
}

}  // namespace

TrainingViews::TrainingViews(Renderer& renderer, int mesh, double bounding_radius_m,
                             const LearnParameters& parameters, const RotationBox& box, std::uint64_t seed)
    : renderer_(renderer),
      mesh_(mesh),
      radius_m_(bounding_radius_m),
      parameters_(parameters),
      box_(box),
      random_(seed) {}

double TrainingViews::uniform(double lo, double hi) {
  // std::uniform_real_distribution differs between standard libraries; this does not.
  return lo + (hi - lo) * (static_cast<double>(random_() >> 11) * 0x1p-53);
}

Pose6 TrainingViews::random_pose() {
  Pose6 pose;
  pose.x = uniform(0, parameters_.camera.width - 1);
  pose.y = uniform(0, parameters_.camera.height - 1);
  pose.z = uniform(std::max(parameters_.min_distance_m, 2.5 * radius_m_),
                   std::max(parameters_.max_distance_m, 3.0 * radius_m_));
  // The lattice poses of the bin are lo..hi-1.
  const auto angle = [&](std::size_t a) {
    return uniform(box_.lo_deg[a] - 0.5, box_.hi_deg[a] - 0.5) * kLatticeAngle;
  };
  pose.rx = angle(0);
  pose.ry = angle(1);
  pose.rz = angle(2);
  return pose;
}

TrainingView TrainingViews::next() {
  TrainingView view;
  view.pose = random_pose();
  view.window = window_around(parameters_.camera, view.pose, radius_m_);
  // A lamp somewhere above the camera's half of the world, and a background of any grey, slightly tinted.
  Light light;
  light.ambient = parameters_.ambient;
  const Eigen::Vector3d centre = parameters_.camera.ray(view.pose.x, view.pose.y) * view.pose.z;
  light.position_in_camera = centre + Eigen::Vector3d(uniform(-2, 2), uniform(-2.5, -0.3), uniform(-2, 1));
  const double grey = uniform(0, 255);
  const Eigen::Vector3d background(grey + uniform(-20, 20), grey + uniform(-20, 20), grey + uniform(-20, 20));
  RenderedView rendered = renderer_.render(parameters_.camera, view.window,
                                           {{mesh_, transform_from_pose(parameters_.camera, view.pose)}},
                                           light, background.cwiseMax(0).cwiseMin(255));
  view.edges = edges_by_direction(rendered.colour, {parameters_.edge_low, parameters_.edge_high});
  view.ray_depth_m = std::move(rendered.ray_depth_m);
  return view;
}

}  // namespace sextant
