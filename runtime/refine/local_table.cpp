// SPDX-License-Identifier: Apache-2.0
#include "runtime/refine/local_table.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

namespace sextant {
namespace {

constexpr std::size_t kFewest = 150;
constexpr std::size_t kWanted = 900;  ///< samples looked at, about
// What no fit can know better: an object may stand on a crumb, a scanned mesh's base is millimetres and
// degrees off (the YCB meshes: up to 8 mm, 2-6 deg).
constexpr double kHeightFloorM = 0.004;
constexpr double kTiltFloorRad = 0.035;  // 2 deg

struct Sample {
  double u = 0, v = 0;  ///< on the stated plane, metres from the point below the object
  double height_m = 0;  ///< over the stated plane
  double sigma_m = 0.002;
};

}  // namespace

LocalTable local_table(const SearchFrame& frame, const TableGeometry& stated, const TableTolerance& tolerance,
                       const DepthRaster& object, const Eigen::Vector3d& centre) {
  LocalTable result{stated, 0.5 * tolerance.height_m + kHeightFloorM,
                    0.5 * tolerance.angle_rad + kTiltFloorRad, false};
  const cv::Rect window = object.window();
  if (window.empty()) return result;
  const Eigen::Vector3d up = stated.up_in_camera.normalized();
  const Eigen::Vector3d side = up.unitOrthogonal();
  const Eigen::Vector3d ahead = up.cross(side);
  const Eigen::Vector3d foot = centre - (up.dot(centre) + stated.camera_height_m) * up;

  const cv::Rect image(0, 0, frame.camera.width, frame.camera.height);
  const cv::Rect around =
      cv::Rect(window.x - window.width, window.y - window.height / 2, 3 * window.width, 2 * window.height) &
      image;
  const int step = std::max(
      2, static_cast<int>(std::sqrt(static_cast<double>(around.area()) / static_cast<double>(kWanted))));
  const double reach = tolerance.height_m + 0.01;
  std::vector<Sample> samples;
  for (int y = around.y; y < around.y + around.height; y += step) {
    const auto* row = frame.ray_depth_m.ptr<float>(y);
    for (int x = around.x; x < around.x + around.width; x += step) {
      if (!(row[x] > 0) || object.triangle(x, y) != DepthRaster::kBackground) continue;
      const Eigen::Vector3d p = frame.camera.ray(x, y) * static_cast<double>(row[x]);
      const double height = up.dot(p) + stated.camera_height_m;
      const Eigen::Vector3d from_foot = p - foot;
      const double distance = from_foot.norm();
      if (std::abs(height) > reach + distance * std::sin(tolerance.angle_rad)) continue;
      samples.push_back({side.dot(from_foot), ahead.dot(from_foot), height,
                         0.001 + 0.002 * static_cast<double>(row[x]) * static_cast<double>(row[x])});
    }
  }
  if (samples.size() < kFewest) return result;

  // height = a + b u + c v; the stated table is the prior, the gate narrows.
  const Eigen::Vector3d prior_sigma(0.5 * tolerance.height_m + 0.002, 0.5 * tolerance.angle_rad + 0.005,
                                    0.5 * tolerance.angle_rad + 0.005);
  Eigen::Vector3d plane = Eigen::Vector3d::Zero();
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  std::size_t inliers = 0;
  for (const double gate_sigmas : {6.0, 5.0, 4.0, 3.0, 3.0}) {
    information = prior_sigma.array().square().inverse().matrix().asDiagonal();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    inliers = 0;
    for (const Sample& s : samples) {
      const Eigen::Vector3d row(1, s.u, s.v);
      const double q = (s.height_m - row.dot(plane)) / (gate_sigmas * s.sigma_m);
      if (std::abs(q) >= 1) continue;
      ++inliers;
      // Tukey's weight; neighbours share their noise: every eighth sample counts.
      const double weight = std::pow(1 - q * q, 2) / (8 * s.sigma_m * s.sigma_m);
      information += weight * row * row.transpose();
      right += weight * s.height_m * row;
    }
    plane = information.ldlt().solve(right);
  }
  if (inliers < kFewest) return result;
  // height = up.p + h = a + b u + c v  <=>  (up - b side - c ahead).p + h - a + (b side + c ahead).foot = 0
  const Eigen::Vector3d slope = plane.y() * side + plane.z() * ahead;
  const Eigen::Vector3d normal = up - slope;
  const double length = normal.norm();
  result.table.up_in_camera = normal / length;
  result.table.camera_height_m = (stated.camera_height_m - plane.x() + slope.dot(foot)) / length;
  const Eigen::Matrix3d covariance = information.inverse();
  result.height_sigma_m = std::hypot(kHeightFloorM, std::sqrt(covariance(0, 0)));
  result.tilt_sigma_rad = std::hypot(kTiltFloorRad, std::sqrt(std::max(covariance(1, 1), covariance(2, 2))));
  result.fitted = true;
  return result;
}

}  // namespace sextant
