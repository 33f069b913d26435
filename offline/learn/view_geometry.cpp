// SPDX-License-Identifier: Apache-2.0
#include "offline/learn/view_geometry.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "runtime/geometry/pose_mapping.h"
#include "runtime/search/lattice.h"

namespace sextant {

cv::Rect window_around(const PinholeCamera& camera, const Pose6& pose, double radius_m, int border_px) {
  const double n = 1 / camera.ray(pose.x, pose.y).z();
  const double half = camera.focal * radius_m / std::sqrt(pose.z * pose.z - radius_m * radius_m) * n * n;
  const int side = 2 * (static_cast<int>(std::ceil(half)) + border_px) + 1;
  return {static_cast<int>(std::lround(pose.x)) - side / 2, static_cast<int>(std::lround(pose.y)) - side / 2,
          side, side};
}

Pose6 random_pose(const LearnParameters& parameters, const RotationBox& box, double radius_m,
                  Random& random) {
  Pose6 pose;
  pose.x = random.uniform(0, parameters.camera.width - 1);
  pose.y = random.uniform(0, parameters.camera.height - 1);
  pose.z = random.uniform(std::max(parameters.min_distance_m, 2.5 * radius_m),
                          std::max(parameters.max_distance_m, 3.0 * radius_m));
  // The lattice poses of the bin lie in lo..hi-1, whole degrees.
  const auto angle = [&](std::size_t a) {
    return random.uniform(box.lo_deg[a] - 0.5, box.hi_deg[a] - 0.5) * kOneDegree;
  };
  pose.rx = angle(0);
  pose.ry = angle(1);
  pose.rz = angle(2);
  return pose;
}

Light random_light(const LearnParameters& parameters, const Pose6& pose, Random& random) {
  Light light;
  light.ambient = parameters.ambient;
  const Eigen::Vector3d centre = parameters.camera.ray(pose.x, pose.y) * pose.z;
  const double x = random.uniform(-2, 2);
  const double y = random.uniform(-2.5, -0.3);
  const double z = random.uniform(-2, 1);
  light.position_in_camera = centre + Eigen::Vector3d(x, y, z);
  return light;
}

RigidTransform camera_from_table(const PinholeCamera& camera, const Pose6& pose, double centre_height_m) {
  return transform_from_pose(camera, pose) * Eigen::Translation3d(0, 0, -centre_height_m);
}

bool table_is_seen(const Pose6& pose) { return pose.ry < -3 * std::numbers::pi / 180; }

}  // namespace sextant
