// SPDX-License-Identifier: Apache-2.0
#include "runtime/search/pose_ball.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "runtime/geometry/pose_mapping.h"

namespace sextant {
namespace {

constexpr double kSlack = 1e-7;  ///< metres or radians: more than rounding (of acos near 1, too) can take

double angle_of(const Eigen::Matrix3d& rotation) {
  return std::acos(std::clamp(0.5 * (rotation.trace() - 1), -1.0, 1.0));
}

/// Upper bound of the angle between the tangent frames of two pixels of the rectangle. The frame is a yaw of
/// atan(px), then a pitch of atan(py / sqrt(1 + px^2)), whose derivatives are at most 1 by py and
/// 0.385 |py| by px.
double tangent_turn(const Eigen::Vector2d& lo, const Eigen::Vector2d& hi) {
  const double tallest = std::max(std::abs(lo.y()), std::abs(hi.y()));
  return (hi.x() - lo.x()) * (1 + 0.385 * tallest) + (hi.y() - lo.y());
}

}  // namespace

PoseBall::PoseBall(const PinholeCamera& camera, const LatticePose& centre, const BallSize& size)
    : camera_(camera), size_(size) {
  const RigidTransform t = transform_from_pose(camera, pose_of(centre));
  centre_ = t.translation();
  const int alike = size.symmetry_deg > 0 ? std::max(1, 360 / size.symmetry_deg) : 1;
  for (int i = 0; i < alike; ++i) {
    orientations_.push_back(
        t.linear() *
        Eigen::AngleAxisd(i * size.symmetry_deg * kOneDegree, Eigen::Vector3d::UnitZ()).toRotationMatrix());
  }
  // Where the ball can project to: its axis-aligned box does, as long as it is in front of the camera.
  const double nearest = centre_.z() - size.radius_m;
  if (nearest <= 0) {
    x_lo_ = y_lo_ = -std::numeric_limits<double>::infinity();
    x_hi_ = y_hi_ = std::numeric_limits<double>::infinity();
    return;
  }
  const double farthest = centre_.z() + size.radius_m;
  const auto least = [&](double v) { return std::min(v / nearest, v / farthest); };
  const auto most = [&](double v) { return std::max(v / nearest, v / farthest); };
  x_lo_ = camera.focal * least(centre_.x() - size.radius_m) + camera.cx - 1;
  x_hi_ = camera.focal * most(centre_.x() + size.radius_m) + camera.cx + 1;
  y_lo_ = camera.focal * least(centre_.y() - size.radius_m) + camera.cy - 1;
  y_hi_ = camera.focal * most(centre_.y() + size.radius_m) + camera.cy + 1;
}

double PoseBall::angle_to(const Eigen::Matrix3d& rotation) const {
  if (size_.symmetry_deg == 0) {
    return std::acos(std::clamp(orientations_[0].col(2).dot(rotation.col(2)), -1.0, 1.0));
  }
  double least = std::numbers::pi;
  for (const Eigen::Matrix3d& o : orientations_) least = std::min(least, angle_of(o.transpose() * rotation));
  return least;
}

bool PoseBall::contains(const LatticePose& pose) const {
  if (pose.at[kX] < x_lo_ || pose.at[kX] > x_hi_ || pose.at[kY] < y_lo_ || pose.at[kY] > y_hi_) return false;
  const RigidTransform t = transform_from_pose(camera_, pose_of(pose));
  return (t.translation() - centre_).norm() <= size_.radius_m && angle_to(t.linear()) <= size_.angle_rad;
}

bool PoseBall::contains_all(const Region& r) const {
  if (r.lo[kX] < x_lo_ || r.hi[kX] > x_hi_ || r.lo[kY] < y_lo_ || r.hi[kY] > y_hi_) return false;
  // Turns about the vertical do not matter where the object is round.
  const int turning = size_.symmetry_deg == 0 ? kRz : kDimensions;
  double half = 0;
  for (int d = kRx; d < turning; ++d) {
    const auto i = static_cast<std::size_t>(d);
    half += 0.5 * (r.hi[i] - r.lo[i]) * kLatticeAngle;
  }
  if (half > size_.angle_rad) return false;
  // The farthest centre: over directions at a corner of the rectangle (those within an angle of a direction
  // are a convex cone), over distances at an end.
  double farthest2 = 0;
  for (const int x : {r.lo[kX], r.hi[kX]}) {
    for (const int y : {r.lo[kY], r.hi[kY]}) {
      const Eigen::Vector3d ray = camera_.ray(x, y);
      if (ray.dot(centre_) <= 0) return false;
      for (const int z : {r.lo[kZ], r.hi[kZ]}) {
        farthest2 = std::max(farthest2, (z * kLatticeDistance * ray - centre_).squaredNorm());
      }
    }
  }
  if (std::sqrt(farthest2) + kSlack > size_.radius_m) return false;
  // No orientation is farther from the middle one than the turns about its axes and of its tangent frame.
  const auto middle = [&](Dimension d) { return 0.5 * (r.lo[d] + r.hi[d]); };
  const Pose6 at{middle(kX),
                 middle(kY),
                 middle(kZ) * kLatticeDistance,
                 middle(kRx) * kLatticeAngle,
                 middle(kRy) * kLatticeAngle,
                 middle(kRz) * kLatticeAngle};
  const double turn = tangent_turn(camera_.tangent(r.lo[kX], r.lo[kY]), camera_.tangent(r.hi[kX], r.hi[kY]));
  return angle_to(transform_from_pose(camera_, at).linear()) + half + turn + kSlack <= size_.angle_rad;
}

}  // namespace sextant
