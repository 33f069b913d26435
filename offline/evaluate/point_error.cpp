// SPDX-License-Identifier: Apache-2.0
#include "offline/evaluate/point_error.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sextant {

double add_m(const std::vector<Eigen::Vector3d>& points, const RigidTransform& estimate,
             const RigidTransform& truth) {
  double sum = 0;
  for (const Eigen::Vector3d& p : points) sum += (estimate * p - truth * p).norm();
  return points.empty() ? 0 : sum / static_cast<double>(points.size());
}

double add_s_m(const std::vector<Eigen::Vector3d>& points, const RigidTransform& estimate,
               const RigidTransform& truth) {
  // Distances do not change when both clouds move: the true one stays in the mesh frame.
  const RigidTransform moved = truth.inverse() * estimate;
  std::vector<Eigen::Vector3d> estimated;
  estimated.reserve(points.size());
  for (const Eigen::Vector3d& p : points) estimated.emplace_back(moved * p);
  double sum = 0;
  for (const Eigen::Vector3d& p : points) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Eigen::Vector3d& q : estimated) nearest = std::min(nearest, (p - q).squaredNorm());
    sum += std::sqrt(nearest);
  }
  return points.empty() ? 0 : sum / static_cast<double>(points.size());
}

std::vector<Eigen::Vector3d> thinned(const std::vector<Eigen::Vector3f>& points, std::size_t count) {
  std::vector<Eigen::Vector3d> kept;
  const std::size_t n = std::min(count, points.size());
  for (std::size_t i = 0; i < n; ++i) kept.emplace_back(points[i * points.size() / n].cast<double>());
  return kept;
}

}  // namespace sextant
