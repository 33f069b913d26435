// SPDX-License-Identifier: Apache-2.0
#include "runtime/geometry/table_geometry.h"

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "runtime/geometry/pose_mapping.h"

namespace sextant {
namespace {

constexpr double kRounding = 1e-9;  ///< outward slack that swallows the rounding of a dozen operations

double sine_of_elevation(const Eigen::Vector3d& down, double px, double py) {
  return (down.x() * px + down.y() * py + down.z()) / std::sqrt(1 + px * px + py * py);
}

/// Largest sine along the segment from a to b (tangent coordinates): at the ends or where it is stationary.
double largest_sine_on_edge(const Eigen::Vector3d& down, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector3d origin(a.x(), a.y(), 1);
  const Eigen::Vector3d step(b.x() - a.x(), b.y() - a.y(), 0);
  double best = std::max(sine_of_elevation(down, a.x(), a.y()), sine_of_elevation(down, b.x(), b.y()));
  // d/dt (down.(o + t s) / |o + t s|) = 0  <=>  t = ((d.s)(o.o) - (d.o)(o.s)) / ((d.o)(s.s) - (d.s)(o.s))
  const double ds = down.dot(step);
  const double d0 = down.dot(origin);
  const double os = origin.dot(step);
  const double denominator = d0 * step.squaredNorm() - ds * os;
  if (denominator != 0) {
    const double t = (ds * origin.squaredNorm() - d0 * os) / denominator;
    if (t > 0 && t < 1) {
      best = std::max(best, sine_of_elevation(down, a.x() + t * step.x(), a.y() + t * step.y()));
    }
  }
  return best;
}

/// Smallest sine along the segment: at the ends, unless the sine is negative between them.
double smallest_sine_on_edge(const Eigen::Vector3d& down, const Eigen::Vector2d& a,
                             const Eigen::Vector2d& b) {
  return -largest_sine_on_edge(-down, a, b);
}

/// Angle of the vector (x, y) from the positive x axis over a box that may hold the origin.
Interval atan2_over(Interval y, Interval x) {
  constexpr double kPi = std::numbers::pi;
  if (x.lo <= 0 && (y.contains(0) || x.hi <= 0)) {
    // Reaches the cut (negative x axis) or its neighbourhood: give up unless y keeps one sign.
    if (y.contains(0)) return {-kPi, kPi};
  }
  const std::array<double, 4> corners{std::atan2(y.lo, x.lo), std::atan2(y.lo, x.hi), std::atan2(y.hi, x.lo),
                                      std::atan2(y.hi, x.hi)};
  return {*std::min_element(corners.begin(), corners.end()),
          *std::max_element(corners.begin(), corners.end())};
}

}  // namespace

TableTolerance widened(const TableTolerance& tolerance, const TableUncertainty& uncertainty) {
  constexpr double kDeviations = 2;
  return {tolerance.height_m + kDeviations * uncertainty.surface_m,
          tolerance.angle_rad + kDeviations * uncertainty.tilt_rad};
}

TableGeometry TableGeometry::from_pitch_roll(double pitch_rad, double roll_rad, double camera_height_m) {
  return {{-std::sin(roll_rad) * std::cos(pitch_rad), -std::cos(roll_rad) * std::cos(pitch_rad),
           -std::sin(pitch_rad)},
          camera_height_m};
}

double TableGeometry::pitch_rad() const {
  return std::atan2(-up_in_camera.z(), std::hypot(up_in_camera.x(), up_in_camera.y()));
}

double TableGeometry::roll_rad() const { return std::atan2(-up_in_camera.x(), -up_in_camera.y()); }

UprightPose upright_pose_at(const PinholeCamera& camera, const Eigen::Vector3d& up_in_camera, double x,
                            double y) {
  const Eigen::Vector3d up = camera_from_tangent(camera, x, y).transpose() * up_in_camera;
  UprightPose pose;
  pose.rx = std::atan2(up.x(), -up.y());
  pose.ry = std::atan2(up.z(), std::hypot(up.x(), up.y()));
  pose.sine_of_elevation = -up.z();
  return pose;
}

bool table_constraint_contains(const PinholeCamera& camera, const TableGeometry& table,
                               double centre_height_m, const TableTolerance& tolerance, const Pose6& pose) {
  const UprightPose upright = upright_pose_at(camera, table.up_in_camera, pose.x, pose.y);
  if (upright.sine_of_elevation <= 0) return false;
  const double drop = table.camera_height_m - centre_height_m;
  return std::abs(std::remainder(pose.rx - upright.rx, 2 * std::numbers::pi)) <= tolerance.angle_rad &&
         std::abs(pose.ry - upright.ry) <= tolerance.angle_rad &&
         std::abs(drop - pose.z * upright.sine_of_elevation) <= tolerance.height_m;
}

UprightRange upright_range_over(const PinholeCamera& camera, const Eigen::Vector3d& up_in_camera, Interval x,
                                Interval y) {
  const Eigen::Vector3d down = -up_in_camera;
  const Eigen::Vector2d t0 = camera.tangent(x.lo, y.lo);
  const Eigen::Vector2d t1 = camera.tangent(x.hi, y.hi);
  const std::array<Eigen::Vector2d, 4> corner{
      Eigen::Vector2d(t0.x(), t0.y()), Eigen::Vector2d(t1.x(), t0.y()), Eigen::Vector2d(t1.x(), t1.y()),
      Eigen::Vector2d(t0.x(), t1.y())};
  UprightRange range;

  // The sine is the cosine of the angle to `down`: its extremes lie on the rectangle's edges, or it is
  // +-1 where the nadir (zenith) projects into the rectangle.
  double smallest = 1;
  double largest = -1;
  for (std::size_t i = 0; i < 4; ++i) {
    largest = std::max(largest, largest_sine_on_edge(down, corner[i], corner[(i + 1) % 4]));
    smallest = std::min(smallest, smallest_sine_on_edge(down, corner[i], corner[(i + 1) % 4]));
  }
  if (down.z() != 0) {
    const double qx = down.x() / down.z();
    const double qy = down.y() / down.z();
    if (t0.x() <= qx && qx <= t1.x() && t0.y() <= qy && qy <= t1.y())
      (down.z() > 0 ? largest : smallest) = down.z() > 0 ? 1 : -1;
  }
  range.sine_of_elevation = intersect(Interval{smallest, largest}.widened(kRounding), Interval{-1, 1});
  range.ry = Interval{-std::asin(range.sine_of_elevation.hi), -std::asin(range.sine_of_elevation.lo)}.widened(
      kRounding);

  // tan rx = (up.right) / -(up.down) with right = (1, 0, -px)/a, down = (-px py, 1 + px^2, -py)/(a n);
  // multiply both by a n > 0.
  const Interval px{t0.x(), t1.x()};
  const Interval py{t0.y(), t1.y()};
  const Interval px2 = square(px);
  const Interval n2 = 1.0 + (px2 + square(py));
  const Interval n{std::sqrt(n2.lo), std::sqrt(n2.hi)};
  const Eigen::Vector3d& u = up_in_camera;
  const Interval right = (u.x() + (-u.z()) * px) * n;
  const Interval up_part = (u.x() * (px * py) + (-u.y()) * (1.0 + px2)) + u.z() * py;
  range.rx = atan2_over(right.widened(kRounding), up_part.widened(kRounding)).widened(kRounding);
  range.rx = intersect(range.rx, Interval{-std::numbers::pi, std::numbers::pi});
  return range;
}

Interval table_distance_range(const TableGeometry& table, double centre_height_m,
                              const TableTolerance& tolerance, Interval sine_of_elevation) {
  const double drop = table.camera_height_m - centre_height_m;
  const double hi = drop + tolerance.height_m;
  if (sine_of_elevation.hi <= 0 || hi < 0) return {1, 0};
  const double lo = std::max(0.0, drop - tolerance.height_m);
  const double infinity = std::numeric_limits<double>::infinity();
  return {lo / sine_of_elevation.hi * (1 - kRounding),
          sine_of_elevation.lo > 0 ? hi / sine_of_elevation.lo * (1 + kRounding) : infinity};
}

}  // namespace sextant
