// SPDX-License-Identifier: Apache-2.0
#include "offline/evaluate/symmetry_group.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace sextant {
namespace {

/// Angle of a rotation, accurate for small ones too.
double angle_of(const Eigen::Matrix3d& rotation) {
  const Eigen::Vector3d twice_sine(rotation(2, 1) - rotation(1, 2), rotation(0, 2) - rotation(2, 0),
                                   rotation(1, 0) - rotation(0, 1));
  return std::atan2(twice_sine.norm(), rotation.trace() - 1);
}

double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

}  // namespace

SymmetryGroup SymmetryGroup::about(const Eigen::Vector3d& up, int degrees) {
  SymmetryGroup group;
  if (degrees == 0) group.axes.push_back(up.normalized());
  for (int turn = degrees; turn > 0 && turn < 360; turn += degrees) {
    group.rotations.emplace_back(Eigen::AngleAxisd(turn * std::numbers::pi / 180, up.normalized()).matrix());
  }
  return group;
}

SymmetryGroup symmetry_group_of(const ModelInfo& info, bool geometric) {
  const Eigen::Vector3d up = info.up.value_or(Eigen::Vector3d::UnitZ());
  if (geometric && info.geometric_symmetry_deg) return SymmetryGroup::about(up, *info.geometric_symmetry_deg);
  if (info.symmetry_deg) return SymmetryGroup::about(up, *info.symmetry_deg);
  SymmetryGroup group;
  for (const RigidTransform& symmetry : info.discrete) group.rotations.emplace_back(symmetry.linear());
  for (const AxialSymmetry& symmetry : info.continuous) group.axes.push_back(symmetry.axis);
  return group;
}

double rotation_error_rad(const Eigen::Matrix3d& estimate, const Eigen::Matrix3d& truth,
                          const SymmetryGroup& group) {
  double best = std::numbers::pi;
  for (const Eigen::Matrix3d& symmetry : group.rotations) {
    const Eigen::Matrix3d equivalent = truth * symmetry;
    best = std::min(best, angle_of(equivalent.transpose() * estimate));
    for (const Eigen::Vector3d& axis : group.axes)
      best = std::min(best, angle_between(estimate * axis, equivalent * axis));
  }
  return best;
}

std::optional<double> turntable_error_rad(const Eigen::Matrix3d& estimate, const Eigen::Matrix3d& truth,
                                          const SymmetryGroup& group, const Eigen::Vector3d& up) {
  const Eigen::Vector3d axis = up.normalized();
  for (const Eigen::Vector3d& symmetry : group.axes) {
    if (std::abs(symmetry.normalized().dot(axis)) > 0.999) return std::nullopt;
  }
  double best = std::numbers::pi;
  for (const Eigen::Matrix3d& symmetry : group.rotations) {
    const Eigen::Quaterniond moved(Eigen::Matrix3d((truth * symmetry).transpose() * estimate));
    // Swing-twist decomposition: the twist about the axis.
    double twist = 2 * std::atan2(moved.vec().dot(axis), moved.w());
    if (twist > std::numbers::pi) twist -= 2 * std::numbers::pi;
    if (twist < -std::numbers::pi) twist += 2 * std::numbers::pi;
    if (std::abs(twist) < std::abs(best)) best = twist;
  }
  return best;
}

}  // namespace sextant
