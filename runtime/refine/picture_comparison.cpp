// SPDX-License-Identifier: Apache-2.0
#include "runtime/refine/picture_comparison.h"

#include <cmath>

namespace sextant {
namespace {

constexpr double kSameM = 0.010;
constexpr int kLeastPixels = 30;
// What is nearer than expected may be something in front: it speaks less against a pose than what is farther.
constexpr double kInFront = 0.5;

/// 0: nothing is known there.
double expected_depth(const PinholeCamera& camera, const std::optional<TableGeometry>& table,
                      const DepthRaster& picture, int x, int y) {
  const Eigen::Vector2d t = camera.tangent(x, y);
  const double stretch = std::sqrt(1 + t.squaredNorm());
  if (picture.triangle(x, y) != DepthRaster::kBackground) {
    return stretch / static_cast<double>(picture.inverse_depth(x, y));
  }
  if (!table) return 0;
  const double sine = -table->up_in_camera.dot(Eigen::Vector3d(t.x(), t.y(), 1)) / stretch;
  return sine > 0.02 ? table->camera_height_m / sine : 0;
}

double unexplained(double measured, double expected) {
  if (std::abs(measured - expected) <= kSameM) return 0;
  return measured > expected ? 1 : kInFront;
}

}  // namespace

double explained_better(const SearchFrame& frame, const std::optional<TableGeometry>& table,
                        const DepthRaster& first, const DepthRaster& second) {
  const cv::Rect image(0, 0, frame.ray_depth_m.cols, frame.ray_depth_m.rows);
  const cv::Rect window = (first.window() | second.window()) & image;
  double advantage = 0;
  int pixels = 0;
  for (int y = window.y; y < window.y + window.height; ++y) {
    const auto* measured = frame.ray_depth_m.ptr<float>(y);
    for (int x = window.x; x < window.x + window.width; ++x) {
      if (!(measured[x] > 0)) continue;
      if (first.triangle(x, y) == DepthRaster::kBackground &&
          second.triangle(x, y) == DepthRaster::kBackground) {
        continue;
      }
      const double a = expected_depth(frame.camera, table, first, x, y);
      const double b = expected_depth(frame.camera, table, second, x, y);
      if (a == 0 || b == 0 || std::abs(a - b) <= kSameM) continue;
      const auto depth = static_cast<double>(measured[x]);
      advantage += unexplained(depth, a) - unexplained(depth, b);
      ++pixels;
    }
  }
  return pixels < kLeastPixels ? 0 : advantage / pixels;
}

}  // namespace sextant
