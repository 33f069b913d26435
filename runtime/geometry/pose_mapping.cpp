// SPDX-License-Identifier: Apache-2.0
#include "runtime/geometry/pose_mapping.h"

#include <algorithm>
#include <cmath>

namespace sextant {
namespace {

// Object seen from the front: x -> right, y -> forward, z -> up.
const Eigen::Matrix3d& tangent_from_upright_object() {
  static const Eigen::Matrix3d kMatrix = (Eigen::Matrix3d() << 1, 0, 0, 0, 0, -1, 0, 1, 0).finished();
  return kMatrix;
}

Eigen::Matrix3d rotation_about(const Eigen::Vector3d& axis, double angle_rad) {
  return Eigen::AngleAxisd(angle_rad, axis).toRotationMatrix();
}

}  // namespace

Eigen::Matrix3d camera_from_tangent(const PinholeCamera& camera, double x, double y) {
  const Eigen::Vector3d forward = camera.ray(x, y);
  const Eigen::Vector3d right = Eigen::Vector3d(forward.z(), 0, -forward.x()).normalized();
  Eigen::Matrix3d m;
  m << right, forward.cross(right), forward;
  return m;
}

RigidTransform transform_from_pose(const PinholeCamera& camera, const Pose6& pose) {
  const Eigen::Matrix3d tangent = camera_from_tangent(camera, pose.x, pose.y);
  RigidTransform t = RigidTransform::Identity();
  t.linear() = tangent * rotation_about(Eigen::Vector3d::UnitZ(), pose.rx) *
               rotation_about(Eigen::Vector3d::UnitX(), -pose.ry) * tangent_from_upright_object() *
               rotation_about(Eigen::Vector3d::UnitZ(), pose.rz);
  t.translation() = pose.z * tangent.col(2);
  return t;
}

Pose6 pose_from_transform(const PinholeCamera& camera, const RigidTransform& camera_from_object) {
  const Eigen::Vector3d centre = camera_from_object.translation();
  const Eigen::Vector2d pixel = camera.project(centre);
  Pose6 pose;
  pose.x = pixel.x();
  pose.y = pixel.y();
  pose.z = centre.norm();
  const Eigen::Matrix3d r =
      camera_from_tangent(camera, pose.x, pose.y).transpose() * camera_from_object.linear();
  // The third column is the object's vertical: (cos(ry) sin(rx), -cos(ry) cos(rx), sin(ry)).
  pose.ry = std::atan2(r(2, 2), std::hypot(r(0, 2), r(1, 2)));
  pose.rx = std::hypot(r(0, 2), r(1, 2)) < 1e-12 ? 0.0 : std::atan2(r(0, 2), -r(1, 2));
  // What is left after rx and ry is B * Rz(rz).
  const Eigen::Matrix3d rest = tangent_from_upright_object().transpose() *
                               rotation_about(Eigen::Vector3d::UnitX(), pose.ry) *
                               rotation_about(Eigen::Vector3d::UnitZ(), -pose.rx) * r;
  pose.rz = std::atan2(rest(1, 0), rest(0, 0));
  return pose;
}

double rotation_angle_between(const RigidTransform& a, const RigidTransform& b) {
  const Eigen::Quaterniond difference(a.linear().transpose() * b.linear());
  return 2 * std::atan2(difference.vec().norm(), std::abs(difference.w()));
}

}  // namespace sextant
