// SPDX-License-Identifier: Apache-2.0
#include "runtime/frame/depth_registration.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "runtime/base/error.h"

namespace sextant {
namespace {

constexpr float kNearest = 0.05F;          ///< metres in front of the colour camera
constexpr float kFarthest = 100.0F;        ///< metres; what lies beyond is no depth of a camera
constexpr float kSameSurface = 0.02F;      ///< of the depth: neighbours that differ by less belong together
constexpr float kLargestFootprint = 3.0F;  ///< of a nominal half pixel, where a surface is stretched
constexpr float kOffset = 16384.0F;        ///< makes pixels positive, so that truncation is floor
constexpr double kLongestBaseline = 2.0;   ///< metres

/// floor() for values above -kOffset, in a form that compilers vectorise.
inline int floor_of(float value) { return static_cast<int>(value + kOffset) - static_cast<int>(kOffset); }

/// Middle between a sample and its neighbour where both lie on one surface, else a nominal half pixel away;
/// never farther than `limit`. sign: on which side the neighbour lies.
inline float edge_between(float at, float z, float other, float other_z, float half, float sign) {
  const bool together = other_z > 0 && std::abs(other_z - z) < kSameSurface * z;
  const float reach = together ? 0.5F * (other - at) * sign : half;
  return at + sign * std::min(reach, kLargestFootprint * half);
}

}  // namespace

DepthRegistration::DepthRegistration(const CameraModel& depth, const CameraModel& colour,
                                     const RigidTransform& colour_from_depth, const std::string& where)
    : depth_(depth),
      colour_(colour),
      rotation_(colour_from_depth.linear().cast<float>()),
      translation_(colour_from_depth.translation().cast<float>()),
      colour_distorted_(colour.has_distortion()),
      half_x_(static_cast<float>(0.5 * colour.fx / depth.fx)),
      half_y_(static_cast<float>(0.5 * colour.fy / depth.fy)) {
  depth.check(where + ": depth camera");
  colour.check(where + ": colour camera");
  const Eigen::Matrix3d& r = colour_from_depth.linear();
  const bool rigid =
      (r.transpose() * r - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < 1e-4 && r.determinant() > 0;
  if (!rigid || !(colour_from_depth.translation().norm() < kLongestBaseline)) {
    throw InputError(where, "the pose of the depth camera in the colour camera is no rigid motion of < 2 m",
                     "give a rotation and a translation in metres");
  }
  const auto width = static_cast<std::size_t>(depth.width);
  const std::size_t pixels = width * static_cast<std::size_t>(depth.height);
  for (auto& coordinate : rays_) coordinate.resize(pixels);
  std::size_t i = 0;
  for (int y = 0; y < depth.height; ++y) {
    for (int x = 0; x < depth.width; ++x, ++i) {
      const Eigen::Vector2d tangent = depth.undistorted_tangent(x, y);
      const Eigen::Vector3d ray = r * Eigen::Vector3d(tangent.x(), tangent.y(), 1);
      for (int k = 0; k < 3; ++k) rays_[k][i] = static_cast<float>(ray[k]);
    }
  }
  for (Row& row : rows_) {
    for (auto* values : {&row.u, &row.v, &row.z}) values->assign(width, 0);
  }
  for (auto* values : {&left_, &right_, &top_, &bottom_}) values->assign(width, 0);
}

void DepthRegistration::project(const cv::Mat& depth, int y, Row& row) const {
  const auto* in = depth.ptr<float>(y);
  const std::size_t start = static_cast<std::size_t>(y) * static_cast<std::size_t>(depth_.width);
  const float* rx = rays_[0].data() + start;
  const float* ry = rays_[1].data() + start;
  const float* rz = rays_[2].data() + start;
  float* u = row.u.data();
  float* v = row.v.data();
  float* z = row.z.data();
  const float tx = translation_.x();
  const float ty = translation_.y();
  const float tz = translation_.z();
  const auto fx = static_cast<float>(colour_.fx);
  const auto fy = static_cast<float>(colour_.fy);
  const auto cx = static_cast<float>(colour_.cx);
  const auto cy = static_cast<float>(colour_.cy);
  const int width = depth_.width;
  // Pixels far outside are clamped there, so that later conversions to integers are defined.
  const float least = -0.5F * kOffset;
  const float most = 2.0F * kOffset;
  for (int x = 0; x < width; ++x) {
    const float d = in[x];
    const float zc = rz[x] * d + tz;
    // Written so that a NaN is missing.
    const bool usable = (d > 0) & (d < kFarthest) & (zc > kNearest);
    const float inverse = 1.0F / (usable ? zc : 1.0F);
    const float dd = usable ? d : 0.0F;
    u[x] = (rx[x] * dd + tx) * inverse;
    v[x] = (ry[x] * dd + ty) * inverse;
    z[x] = usable ? zc : 0.0F;
  }
  if (colour_distorted_) {
    for (int x = 0; x < width; ++x) {
      if (z[x] <= 0) continue;
      const Eigen::Vector2d p = colour_.distorted_pixel({u[x], v[x]});
      u[x] = std::clamp(static_cast<float>(p.x()), least, most);
      v[x] = std::clamp(static_cast<float>(p.y()), least, most);
    }
    return;
  }
  for (int x = 0; x < width; ++x) {
    u[x] = std::min(std::max(fx * u[x] + cx, least), most);
    v[x] = std::min(std::max(fy * v[x] + cy, least), most);
  }
}

void DepthRegistration::splat(const Row& above, const Row& row, const Row& below, cv::Mat& out) {
  const int width = depth_.width;
  const float* u = row.u.data();
  const float* v = row.v.data();
  const float* z = row.z.data();
  for (int x = 0; x < width; ++x) {
    const int before = std::max(x - 1, 0);
    const int after = std::min(x + 1, width - 1);
    // At the border of the image the neighbour is the sample itself: made missing by its depth.
    left_[x] = edge_between(u[x], z[x], u[before], x > 0 ? z[before] : 0, half_x_, -1);
    right_[x] = edge_between(u[x], z[x], u[after], x + 1 < width ? z[after] : 0, half_x_, 1);
    top_[x] = edge_between(v[x], z[x], above.v[x], above.z[x], half_y_, -1);
    bottom_[x] = edge_between(v[x], z[x], below.v[x], below.z[x], half_y_, 1);
  }
  for (int x = 0; x < width; ++x) {
    if (z[x] <= 0) continue;
    // The centres in (left, right] x (top, bottom]: half-open, so that touching footprints share none.
    const int x0 = std::max(floor_of(left_[x]) + 1, 0);
    const int x1 = std::min(floor_of(right_[x]), colour_.width - 1);
    const int y0 = std::max(floor_of(top_[x]) + 1, 0);
    const int y1 = std::min(floor_of(bottom_[x]), colour_.height - 1);
    for (int yy = y0; yy <= y1; ++yy) {
      auto* target = out.ptr<float>(yy);
      for (int xx = x0; xx <= x1; ++xx) {
        if (target[xx] == 0 || z[x] < target[xx]) target[xx] = z[x];
      }
    }
  }
}

cv::Mat DepthRegistration::registered(const cv::Mat& axial_depth_m) {
  if (axial_depth_m.type() != CV_32FC1 || axial_depth_m.size() != cv::Size(depth_.width, depth_.height)) {
    throw InputError("depth image",
                     "is " + std::to_string(axial_depth_m.cols) + " x " + std::to_string(axial_depth_m.rows) +
                         ", the depth camera's calibration is for " + std::to_string(depth_.width) + " x " +
                         std::to_string(depth_.height) + " metres in 32 bits",
                     "give the calibration of that size");
  }
  cv::Mat out = cv::Mat::zeros(colour_.height, colour_.width, CV_32FC1);
  Row* above = &rows_[0];
  Row* row = &rows_[1];
  Row* below = &rows_[2];
  std::fill(above->z.begin(), above->z.end(), 0.0F);
  project(axial_depth_m, 0, *row);
  for (int y = 0; y < depth_.height; ++y) {
    if (y + 1 < depth_.height) {
      project(axial_depth_m, y + 1, *below);
    } else {
      std::fill(below->z.begin(), below->z.end(), 0.0F);
    }
    splat(*above, *row, *below, out);
    std::swap(above, row);
    std::swap(row, below);
  }
  return out;
}

}  // namespace sextant
