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
constexpr float kMissing = 1e9F;           ///< metres: farther than any sample
constexpr double kLongestBaseline = 2.0;   ///< metres

/// floor() for values above -kOffset, in a form that compilers vectorise.
inline int floor_of(float value) { return static_cast<int>(value + kOffset) - static_cast<int>(kOffset); }

/// How far a footprint reaches towards a neighbour `step` pixels away: half the way where both samples lie on
/// one surface, else a nominal half pixel; never farther than `limit`. No branches: compilers vectorise it.
inline float reach_of(float step, float z, float other_z, float half, float limit) {
  const bool together = (other_z > 0.0F) & (std::abs(other_z - z) < kSameSurface * z);
  const float reach = together ? 0.5F * step : half;
  return reach < limit ? reach : limit;
}

/// Where the colour image is coarser, every sample has so many pixels a side: more would fall into the same
/// pixels.
int samples_apart(const CameraModel& depth, const CameraModel& colour) {
  const double finer = std::min(depth.fx / colour.fx, depth.fy / colour.fy);
  return std::clamp(static_cast<int>(finer + 0.05), 1, std::max(1, std::min(depth.width, depth.height)));
}

}  // namespace

DepthRegistration::DepthRegistration(const CameraModel& depth, const CameraModel& colour,
                                     const RigidTransform& colour_from_depth, const std::string& where)
    : depth_(depth),
      colour_(colour),
      rotation_(colour_from_depth.linear().cast<float>()),
      translation_(colour_from_depth.translation().cast<float>()),
      colour_distorted_(colour.has_distortion()),
      stride_(samples_apart(depth, colour)),
      columns_(depth.width / stride_),
      half_x_(static_cast<float>(0.5 * stride_ * colour.fx / depth.fx)),
      half_y_(static_cast<float>(0.5 * stride_ * colour.fy / depth.fy)) {
  depth.check(where + ": depth camera");
  colour.check(where + ": colour camera");
  const Eigen::Matrix3d& r = colour_from_depth.linear();
  const bool rigid =
      (r.transpose() * r - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < 1e-4 && r.determinant() > 0;
  if (!rigid || !(colour_from_depth.translation().norm() < kLongestBaseline)) {
    throw InputError(where, "the pose of the depth camera in the colour camera is no rigid motion of < 2 m",
                     "give a rotation and a translation in metres");
  }
  for (const double x : {-0.5, 0.5 * colour.width, colour.width - 0.5}) {
    for (const double y : {-0.5, 0.5 * colour.height, colour.height - 0.5}) {
      const double tangent2 = colour.undistorted_tangent(x, y).squaredNorm();
      farthest_tangent2_ = std::max(farthest_tangent2_, static_cast<float>(1.1 * tangent2));
    }
  }
  const auto width = static_cast<std::size_t>(columns_);
  const std::size_t pixels = width * static_cast<std::size_t>(rows());
  for (auto& coordinate : rays_) coordinate.resize(pixels);
  std::size_t i = 0;
  for (int y = 0; y < rows(); ++y) {
    for (int x = 0; x < columns_; ++x, ++i) {
      const Eigen::Vector2d tangent = depth.undistorted_tangent(pixel_of(x), pixel_of(y));
      const Eigen::Vector3d ray = r * Eigen::Vector3d(tangent.x(), tangent.y(), 1);
      for (int k = 0; k < 3; ++k) rays_[k][i] = static_cast<float>(ray[k]);
    }
  }
  for (Row& row : row_buffers_) {
    for (auto* values : {&row.u, &row.v, &row.z}) values->assign(width + 2, 0);
  }
  for (auto* values : {&left_, &right_, &top_, &bottom_}) values->assign(width, 0);
}

void DepthRegistration::project(const cv::Mat& depth, int y, Row& row) const {
  const float* __restrict in = depth.ptr<float>(pixel_of(y)) + pixel_of(0);
  const std::size_t start = static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_);
  const float* rx = rays_[0].data() + start;
  const float* ry = rays_[1].data() + start;
  const float* rz = rays_[2].data() + start;
  float* __restrict u = row.u.data() + 1;
  float* __restrict v = row.v.data() + 1;
  float* __restrict z = row.z.data() + 1;
  const float tx = translation_.x();
  const float ty = translation_.y();
  const float tz = translation_.z();
  const auto fx = static_cast<float>(colour_.fx);
  const auto fy = static_cast<float>(colour_.fy);
  const auto cx = static_cast<float>(colour_.cx);
  const auto cy = static_cast<float>(colour_.cy);
  const int width = columns_;
  const int stride = stride_;
  // Pixels far outside are clamped there, so that later conversions to integers are defined.
  const float least = -0.5F * kOffset;
  const float most = 2.0F * kOffset;
  // Written for compilers to vectorise: one selection a line, no &&, two loops instead of a guarded division.
  for (int x = 0; x < width; ++x) {
    const float d = std::max(0.0F, in[x * stride]);  // a NaN becomes 0
    const float there = rz[x] * d + tz;
    const float margin = std::min(std::min(d, kFarthest - d), there - kNearest);
    u[x] = margin > 0.0F ? d : 0.0F;
    z[x] = margin > 0.0F ? there : 0.0F;
  }
  for (int x = 0; x < width; ++x) {
    const float d = u[x];
    const float inverse = 1.0F / std::max(z[x], kNearest);
    u[x] = (rx[x] * d + tx) * inverse;
    v[x] = (ry[x] * d + ty) * inverse;
  }
  if (colour_distorted_) {
    for (int x = 0; x < width; ++x) {
      if (z[x] <= 0) continue;
      // Far outside of the image the lens polynomial may fold back into it.
      if (u[x] * u[x] + v[x] * v[x] > farthest_tangent2_) {
        z[x] = 0;
        continue;
      }
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

void DepthRegistration::splat(const Row& above_row, const Row& row, const Row& below_row, cv::Mat& out) {
  const int width = columns_;
  // Behind the leading missing sample.
  const float* u = row.u.data() + 1;
  const float* v = row.v.data() + 1;
  const float* z = row.z.data() + 1;
  const float* v_above = above_row.v.data() + 1;
  const float* z_above = above_row.z.data() + 1;
  const float* v_below = below_row.v.data() + 1;
  const float* z_below = below_row.z.data() + 1;
  int* __restrict left = left_.data();
  int* __restrict right = right_.data();
  int* __restrict top = top_.data();
  int* __restrict bottom = bottom_.data();
  const float half_x = half_x_;
  const float half_y = half_y_;
  const float limit_x = kLargestFootprint * half_x;
  const float limit_y = kLargestFootprint * half_y;
  // The centres in (left, right] x (top, bottom]: half-open, so that touching footprints share none.
  for (int x = 0; x < width; ++x) {
    left[x] = floor_of(u[x] - reach_of(u[x] - u[x - 1], z[x], z[x - 1], half_x, limit_x)) + 1;
    right[x] = floor_of(u[x] + reach_of(u[x + 1] - u[x], z[x], z[x + 1], half_x, limit_x));
  }
  for (int x = 0; x < width; ++x) {
    top[x] = floor_of(v[x] - reach_of(v[x] - v_above[x], z[x], z_above[x], half_y, limit_y)) + 1;
    bottom[x] = floor_of(v[x] + reach_of(v_below[x] - v[x], z[x], z_below[x], half_y, limit_y));
  }
  const int last_x = colour_.width - 1;
  const int last_y = colour_.height - 1;
  const std::size_t step = out.step1();
  auto* pixels = out.ptr<float>();
  for (int x = 0; x < width; ++x) {
    const bool empty = !(z[x] > 0.0F) | (right[x] < left[x]) | (bottom[x] < top[x]) | (right[x] < 0) |
                       (bottom[x] < 0) | (left[x] > last_x) | (top[x] > last_y);
    // Missing is "infinitely far" here: registered() turns it into 0 at the end.
    const float depth = empty ? kMissing : z[x];
    const int x0 = std::clamp(left[x], 0, last_x);
    const int y0 = std::clamp(top[x], 0, last_y);
    const int x1 = std::clamp(right[x], x0, last_x);
    const int y1 = std::clamp(bottom[x], y0, last_y);
    // Nearly every footprint has one or two pixels a side: its corners are all of it. No branch depends on
    // which, for there would be no predicting it.
    if ((x1 - x0 <= 1) & (y1 - y0 <= 1)) [[likely]] {
      float* upper = pixels + static_cast<std::size_t>(y0) * step;
      float* lower = pixels + static_cast<std::size_t>(y1) * step;
      upper[x0] = std::min(upper[x0], depth);
      upper[x1] = std::min(upper[x1], depth);
      lower[x0] = std::min(lower[x0], depth);
      lower[x1] = std::min(lower[x1], depth);
      continue;
    }
    for (int yy = y0; yy <= y1; ++yy) {
      float* target = pixels + static_cast<std::size_t>(yy) * step;
      for (int xx = x0; xx <= x1; ++xx) target[xx] = std::min(target[xx], depth);
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
  cv::Mat out(colour_.height, colour_.width, CV_32FC1, cv::Scalar(kMissing));
  Row* above = &row_buffers_[0];
  Row* row = &row_buffers_[1];
  Row* below = &row_buffers_[2];
  std::fill(above->z.begin(), above->z.end(), 0.0F);
  project(axial_depth_m, 0, *row);
  for (int y = 0; y < rows(); ++y) {
    if (y + 1 < rows()) {
      project(axial_depth_m, y + 1, *below);
    } else {
      std::fill(below->z.begin(), below->z.end(), 0.0F);
    }
    splat(*above, *row, *below, out);
    std::swap(above, row);
    std::swap(row, below);
  }
  for (int y = 0; y < out.rows; ++y) {
    auto* pixels = out.ptr<float>(y);
    for (int x = 0; x < out.cols; ++x) pixels[x] = pixels[x] < kMissing ? pixels[x] : 0.0F;
  }
  return out;
}

}  // namespace sextant
