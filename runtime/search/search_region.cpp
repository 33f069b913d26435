// SPDX-License-Identifier: Apache-2.0
#include "runtime/search/search_region.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sextant {
namespace {

constexpr double kSlack = 1e-9;  ///< metres: more than rounding can take

/// Distances z > 0 for which z * slope + offset lies in [lo, hi] for some slope of the interval.
Interval distances_between(Interval slope, double lo, double hi) {
  Interval z{0, std::numeric_limits<double>::infinity()};
  // z * slope.lo <= hi and z * slope.hi >= lo
  if (slope.lo > 0) z.hi = std::min(z.hi, hi / slope.lo);
  if (slope.lo < 0) z.lo = std::max(z.lo, hi / slope.lo);
  if (slope.lo == 0 && hi < 0) z.hi = -1;
  if (slope.hi > 0) z.lo = std::max(z.lo, lo / slope.hi);
  if (slope.hi < 0) z.hi = std::min(z.hi, lo / slope.hi);
  if (slope.hi == 0 && lo > 0) z.hi = -1;
  return z;
}

}  // namespace

bool WorkspaceBox::contains(const Eigen::Vector3d& p_in_camera) const {
  const Eigen::Vector3d p = workspace_from_camera * p_in_camera;
  return (p.array() >= lo.array()).all() && (p.array() <= hi.array()).all();
}

Interval WorkspaceBox::distances_over(const PinholeCamera& camera, Interval x, Interval y) const {
  const Eigen::Vector2d first = camera.tangent(x.lo, y.lo), last = camera.tangent(x.hi, y.hi);
  const Interval px{first.x(), last.x()}, py{first.y(), last.y()};
  const Interval px2 = square(px), py2 = square(py);
  const Interval norm{std::sqrt(1 + px2.lo + py2.lo), std::sqrt(1 + px2.hi + py2.hi)};
  Interval z{0, std::numeric_limits<double>::infinity()};
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d a = workspace_from_camera.linear().row(axis);
    const Interval along = a.z() + (a.x() * px + a.y() * py);
    // The unit ray's component: what is along the axis, over the ray's length.
    const Interval slope{std::min(along.lo / norm.lo, along.lo / norm.hi) - 1e-12,
                         std::max(along.hi / norm.lo, along.hi / norm.hi) + 1e-12};
    const double offset = workspace_from_camera.translation()[axis];
    z = intersect(z, distances_between(slope, lo[axis] - offset - kSlack, hi[axis] - offset + kSlack));
  }
  return z;
}

RigidTransform table_from_camera(const TableGeometry& table) {
  const Eigen::Vector3d up = table.up_in_camera.normalized();
  Eigen::Vector3d forward = Eigen::Vector3d::UnitZ() - up.z() * up;
  if (forward.norm() < 1e-6) forward = -Eigen::Vector3d::UnitY() + up.y() * up;
  forward.normalize();
  RigidTransform t = RigidTransform::Identity();
  t.linear().row(0) = forward;
  t.linear().row(1) = up.cross(forward);
  t.linear().row(2) = up;
  t.translation() = Eigen::Vector3d(0, 0, table.camera_height_m);
  return t;
}

PixelRectangle rectified_rectangle(const CameraModel& camera, const PinholeCamera& ideal, double x, double y,
                                   double width, double height) {
  double x0 = std::numeric_limits<double>::infinity(), y0 = x0, x1 = -x0, y1 = -x0;
  const auto see = [&](double u, double v) {
    const Eigen::Vector2d t = camera.undistorted_tangent(u, v);
    x0 = std::min(x0, ideal.cx + ideal.focal * t.x());
    x1 = std::max(x1, ideal.cx + ideal.focal * t.x());
    y0 = std::min(y0, ideal.cy + ideal.focal * t.y());
    y1 = std::max(y1, ideal.cy + ideal.focal * t.y());
  };
  const int columns = std::max(1, static_cast<int>(width)), rows = std::max(1, static_cast<int>(height));
  for (int i = 0; i < columns; ++i) {
    see(x + i, y);
    see(x + i, y + rows - 1);
  }
  for (int i = 0; i < rows; ++i) {
    see(x, y + i);
    see(x + columns - 1, y + i);
  }
  const auto pixel = [](double v) { return static_cast<int>(std::clamp(v, -1e6, 1e6)); };
  // What falls on a pixel up to rounding is that pixel.
  return {pixel(std::floor(x0 + 1e-6)), pixel(std::floor(y0 + 1e-6)), pixel(std::ceil(x1 - 1e-6)),
          pixel(std::ceil(y1 - 1e-6))};
}

}  // namespace sextant
