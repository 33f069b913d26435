// SPDX-License-Identifier: Apache-2.0
#include "runtime/frame/table_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace sextant {
namespace {

constexpr int kRounds = 6;
constexpr int kFewest = 50;
constexpr int kPatchColumns = 8;
constexpr int kPatchRows = 6;
/// What a depth camera's own calibration leaves, and one frame's residuals do not show: a shift of the plane
/// where it was seen, and a tilt about that place.
constexpr double kCalibrationShift = 0.001;                        ///< metres
constexpr double kCalibrationTilt = 0.2 * std::numbers::pi / 180;  ///< radians

/// Linear least squares of a small change of a plane: tilt about two axes and a shift along the normal.
struct NormalEquations {
  Eigen::Vector3d centre{0, 0, 0};
  Eigen::Vector3d e1{0, 0, 0}, e2{0, 0, 0};  ///< in the plane
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  std::array<Eigen::Vector3d, kPatchColumns * kPatchRows> by_patch;
  int inliers = 0;
  double squares = 0;

  Eigen::Vector3d row(const Eigen::Vector3d& p) const { return {e1.dot(p - centre), e2.dot(p - centre), 1}; }
};

double weight_at(double z) {
  const double deviation = depth_deviation(z);
  return 1 / (deviation * deviation);
}

template <typename Visit>
void for_each_inlier(const TablePoints& points, const TablePlane& plane, double slack, Visit visit) {
  for (int y = 0; y < points.rows; ++y) {
    for (int x = 0; x < points.columns; ++x) {
      const Eigen::Vector3f& sample = points.at(x, y);
      if (sample.z() <= 0) continue;
      const Eigen::Vector3d p = sample.cast<double>();
      if (!lies_on(plane, p, slack)) continue;
      const int patch = (y * kPatchRows / points.rows) * kPatchColumns + x * kPatchColumns / points.columns;
      visit(p, static_cast<std::size_t>(patch));
    }
  }
}

NormalEquations normal_equations(const TablePoints& points, const TablePlane& plane, double slack) {
  NormalEquations n;
  n.by_patch.fill(Eigen::Vector3d::Zero());
  double total = 0;
  for_each_inlier(points, plane, slack, [&](const Eigen::Vector3d& p, std::size_t) {
    const double w = weight_at(p.z());
    n.centre += w * p;
    total += w;
  });
  if (total > 0) n.centre /= total;
  n.e1 = plane.up.unitOrthogonal();
  n.e2 = plane.up.cross(n.e1);
  for_each_inlier(points, plane, slack, [&](const Eigen::Vector3d& p, std::size_t patch) {
    const double w = weight_at(p.z());
    const double r = plane.above(p);
    const Eigen::Vector3d a = n.row(p);
    n.information += w * a * a.transpose();
    n.gradient += w * r * a;
    n.by_patch[patch] += w * r * a;
    n.squares += r * r;
    ++n.inliers;
  });
  return n;
}

/// The plane after the change.
TablePlane changed(const TablePlane& plane, const NormalEquations& n, const Eigen::Vector3d& change) {
  // Turning about `centre`, where the rows were taken.
  const Eigen::Vector3d up = (plane.up + change.x() * n.e1 + change.y() * n.e2).normalized();
  const double at_centre = plane.above(n.centre) + change.z();
  return {up, at_centre - up.dot(n.centre)};
}

TableUncertainty uncertainty_of(const TablePoints& points, const TablePlane& plane,
                                const NormalEquations& n) {
  Eigen::Matrix3d scores = Eigen::Matrix3d::Zero();
  double patches = 0;
  for (const Eigen::Vector3d& s : n.by_patch) {
    if (s.isZero()) continue;
    scores += s * s.transpose();
    ++patches;
  }
  // Few patches say little about themselves: the usual small-sample factor of clustered errors.
  const double factor = patches > 4 ? patches / (patches - 3) : 4;
  const Eigen::Matrix3d inverse = n.information.inverse();
  Eigen::Matrix3d covariance = factor * inverse * scores * inverse;
  // A tilt about where the plane was seen moves the point below the camera, and with it the height.
  const auto square = [](double v) { return v * v; };
  covariance.diagonal() +=
      Eigen::Vector3d(square(kCalibrationTilt), square(kCalibrationTilt), square(kCalibrationShift));

  TableUncertainty u;
  const Eigen::Vector3d& up = plane.up;
  const auto deviation = [&](const Eigen::Vector3d& g) {
    return std::sqrt(std::max(0.0, g.dot(covariance * g)));
  };
  u.height_m = deviation({-n.e1.dot(n.centre), -n.e2.dot(n.centre), 1});
  const Eigen::Matrix2d tilt = covariance.topLeftCorner<2, 2>();
  u.tilt_rad =
      std::sqrt(std::max(0.0, Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(tilt).eigenvalues()[1]));
  const double level2 = up.x() * up.x() + up.y() * up.y();
  if (level2 > 1e-4) {
    u.pitch_rad = deviation({-n.e1.z() / std::sqrt(level2), -n.e2.z() / std::sqrt(level2), 0});
    const auto roll = [&](const Eigen::Vector3d& e) { return (up.y() * e.x() - up.x() * e.y()) / level2; };
    u.roll_rad = deviation({roll(n.e1), roll(n.e2), 0});
  } else {
    u.pitch_rad = u.tilt_rad;
    u.roll_rad = std::numbers::pi;
  }
  for_each_inlier(points, plane, 1, [&](const Eigen::Vector3d& p, std::size_t) {
    u.surface_m = std::max(u.surface_m, deviation(n.row(p)));
  });
  return u;
}

}  // namespace

double depth_deviation(double z) { return 0.0008 + 0.0016 * z * z; }

bool lies_on(const TablePlane& plane, const Eigen::Vector3d& p, double slack) {
  // Noise runs along the ray: less of it reaches a plane that is seen at a grazing angle, but warp does.
  return std::abs(plane.above(p)) <= slack * 2.5 * depth_deviation(p.z());
}

TableFit fit_table(const TablePoints& points, const TablePlane& start) {
  TableFit fit;
  fit.plane = start;
  NormalEquations n;
  for (int round = 0; round < kRounds; ++round) {
    // From generous to strict: the start comes from three noisy samples.
    const double slack = round < 2 ? 2.0 - 0.5 * round : 1.0;
    n = normal_equations(points, fit.plane, slack);
    if (n.inliers < kFewest) return fit;
    fit.plane = changed(fit.plane, n, n.information.ldlt().solve(-n.gradient));
  }
  n = normal_equations(points, fit.plane, 1);
  if (n.inliers < kFewest) return fit;
  fit.inliers = n.inliers;
  fit.residual_m = std::sqrt(n.squares / n.inliers);
  fit.uncertainty = uncertainty_of(points, fit.plane, n);
  return fit;
}

}  // namespace sextant
