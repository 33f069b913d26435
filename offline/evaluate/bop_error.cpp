// SPDX-License-Identifier: Apache-2.0
#include "offline/evaluate/bop_error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace sextant {
namespace {

constexpr int kContinuousSteps = 315;  ///< ceil(pi / 0.01)

RigidTransform about_point(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& point) {
  RigidTransform t = RigidTransform::Identity();
  t.linear() = rotation;
  t.translation() = point - rotation * point;
  return t;
}

}  // namespace

std::vector<RigidTransform> symmetry_transforms(const SymmetryGroup& group, const Eigen::Vector3d& centre_m) {
  std::vector<RigidTransform> all;
  for (const Eigen::Matrix3d& rotation : group.rotations) {
    const RigidTransform finite = about_point(rotation, centre_m);
    if (group.axes.empty()) all.push_back(finite);
    for (const Eigen::Vector3d& axis : group.axes) {
      for (int step = 0; step < kContinuousSteps; ++step) {
        const double angle = 2 * std::numbers::pi * step / kContinuousSteps;
        all.push_back(finite * about_point(Eigen::AngleAxisd(angle, axis.normalized()).matrix(), centre_m));
      }
    }
  }
  return all;
}

double mssd_m(const std::vector<Eigen::Vector3d>& points, const RigidTransform& estimate,
              const RigidTransform& truth, const std::vector<RigidTransform>& symmetries) {
  double best = std::numeric_limits<double>::infinity();
  for (const RigidTransform& symmetry : symmetries) {
    const RigidTransform equivalent = truth * symmetry;
    double worst = 0;
    for (const Eigen::Vector3d& p : points) {
      worst = std::max(worst, (estimate * p - equivalent * p).squaredNorm());
      if (worst >= best) break;
    }
    best = std::min(best, worst);
  }
  return std::sqrt(best);
}

double mspd_px(const std::vector<Eigen::Vector3d>& points, const CameraModel& camera,
               const RigidTransform& estimate, const RigidTransform& truth,
               const std::vector<RigidTransform>& symmetries) {
  const double never = std::numeric_limits<double>::infinity();
  // Without distortion, as the challenge projects.
  const auto pixel = [&](const Eigen::Vector3d& p) {
    return Eigen::Vector2d(camera.fx * p.x() / p.z() + camera.cx, camera.fy * p.y() / p.z() + camera.cy);
  };
  std::vector<Eigen::Vector2d> estimated;
  estimated.reserve(points.size());
  for (const Eigen::Vector3d& p : points) {
    const Eigen::Vector3d q = estimate * p;
    if (!(q.z() > 0)) return never;
    estimated.push_back(pixel(q));
  }
  double best = never;
  for (const RigidTransform& symmetry : symmetries) {
    const RigidTransform equivalent = truth * symmetry;
    double worst = 0;
    for (std::size_t i = 0; i < points.size() && worst < best; ++i) {
      const Eigen::Vector3d q = equivalent * points[i];
      worst = q.z() > 0 ? std::max(worst, (estimated[i] - pixel(q)).squaredNorm()) : never;
    }
    best = std::min(best, worst);
  }
  return std::sqrt(best);
}

std::vector<double> vsd(const cv::Mat& estimate_m, const cv::Mat& truth_m, const cv::Mat& measured_m,
                        double diameter_m) {
  // Is the surface at distance d seen where the sensor measured m?
  const auto seen = [](float d, float m) { return d > 0 && (m <= 0 || d - m <= kVsdDeltaM); };
  int in_either = 0;
  int in_one = 0;
  std::vector<int> apart(kBopThresholds, 0);
  for (int y = 0; y < measured_m.rows; ++y) {
    for (int x = 0; x < measured_m.cols; ++x) {
      const float e = estimate_m.at<float>(y, x);
      const float t = truth_m.at<float>(y, x);
      if (e <= 0 && t <= 0) continue;
      const float m = measured_m.at<float>(y, x);
      const bool truth_seen = seen(t, m);
      // What hides the estimate may be the true object itself.
      const bool estimate_seen = seen(e, m) || (e > 0 && truth_seen);
      if (!truth_seen && !estimate_seen) continue;
      ++in_either;
      if (!(truth_seen && estimate_seen)) {
        ++in_one;
        continue;
      }
      const double distance = std::abs(static_cast<double>(e) - t) / diameter_m;
      for (int i = 0; i < kBopThresholds; ++i)
        apart[static_cast<std::size_t>(i)] += distance >= bop_share(i) ? 1 : 0;
    }
  }
  std::vector<double> errors;
  for (const int count : apart)
    errors.push_back(in_either > 0 ? static_cast<double>(count + in_one) / in_either : 1);
  return errors;
}

}  // namespace sextant
