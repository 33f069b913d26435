// SPDX-License-Identifier: Apache-2.0
#include "runtime/frame/table_estimate.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <random>
#include <vector>

namespace sextant {
namespace {

constexpr int kStep = 4;  ///< pixels between samples
constexpr int kRounds = 600;
constexpr std::size_t kFewest = 200;
constexpr double kLeastShare = 0.15;
constexpr double kFarthest = 2.5;         ///< metres; beyond it, depth is too coarse to help
constexpr double kLeastDownward = 0.087;  ///< sine of 5 deg

/// Distance within which a point counts as on the plane: sensor noise grows with the square of depth.
double inlier_distance(double z) { return 0.004 + 0.003 * z * z; }

struct Plane {
  Eigen::Vector3d up{0, 0, 0};
  double height = 0;  ///< of the camera above it
  bool usable() const { return height > 0.05 && -up.z() > kLeastDownward * 0.5 && -up.y() > -0.5; }
};

/// Plane through a point, normal turned towards the camera.
Plane plane_at(const Eigen::Vector3d& point, Eigen::Vector3d normal) {
  if (normal.dot(point) > 0) normal = -normal;
  return {normal, -normal.dot(point)};
}

double distance_to(const Plane& plane, const Eigen::Vector3d& p) {
  return std::abs(plane.up.dot(p) + plane.height);
}

Plane least_squares(const std::vector<Eigen::Vector3d>& points, const Plane& near) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  double n = 0;
  for (const auto& p : points) {
    if (distance_to(near, p) > inlier_distance(p.norm())) continue;
    mean += p;
    ++n;
  }
  if (n < 3) return near;
  mean /= n;
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const auto& p : points) {
    if (distance_to(near, p) <= inlier_distance(p.norm())) scatter += (p - mean) * (p - mean).transpose();
  }
  return plane_at(mean, Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvectors().col(0));
}

std::size_t count_inliers(const std::vector<Eigen::Vector3d>& points, const Plane& plane) {
  std::size_t n = 0;
  for (const auto& p : points) n += distance_to(plane, p) <= inlier_distance(p.norm()) ? 1U : 0U;
  return n;
}

}  // namespace

std::optional<TableEstimate> estimate_table(const SearchFrame& frame) {
  std::vector<Eigen::Vector3d> points;
  for (int y = 0; y < frame.camera.height; y += kStep) {
    const auto* row = frame.ray_depth_m.ptr<float>(y);
    for (int x = 0; x < frame.camera.width; x += kStep) {
      if (row[x] > 0 && row[x] < kFarthest) points.emplace_back(frame.camera.ray(x, y) * row[x]);
    }
  }
  if (points.size() < kFewest) return std::nullopt;

  std::mt19937 random(1);  // fixed: the same image gives the same plane
  Plane best;
  std::size_t most = 0;
  for (int round = 0; round < kRounds; ++round) {
    const auto& a = points[random() % points.size()];
    const auto& b = points[random() % points.size()];
    const auto& c = points[random() % points.size()];
    const Eigen::Vector3d normal = (b - a).cross(c - a);
    if (normal.norm() < 1e-4) continue;
    const Plane plane = plane_at(a, normal.normalized());
    if (!plane.usable()) continue;
    const std::size_t inliers = count_inliers(points, plane);
    if (inliers > most) {
      most = inliers;
      best = plane;
    }
  }
  if (most == 0) return std::nullopt;
  for (int i = 0; i < 5; ++i) best = least_squares(points, best);
  const double share = static_cast<double>(count_inliers(points, best)) / static_cast<double>(points.size());
  if (share < kLeastShare || !best.usable()) return std::nullopt;
  return TableEstimate{{best.up, best.height}, share};
}

}  // namespace sextant
