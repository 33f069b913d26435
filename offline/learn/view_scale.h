// SPDX-License-Identifier: Apache-2.0
// Between a training view's pixels and positions around the object's centre in tangent * metre.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/core.hpp>
#include <vector>

#include "offline/learn/training_view.h"

namespace sextant {

/// Positions around the object's centre, tangent * metre.
using Positions = std::vector<Eigen::Vector2d>;

struct ViewScale {
  const TrainingView& view;
  double scale;  ///< pixels per (tangent * metre)

  ViewScale(const TrainingView& v, double focal) : view(v), scale(focal / v.pose.z) {}
  /// Pixel of the window, clamped to it.
  cv::Point pixel(const Eigen::Vector2d& p) const {
    const auto at = [&](double centre, double offset, int origin, int size) {
      return std::clamp(static_cast<int>(std::floor(centre + scale * offset + 0.5)) - origin, 0, size - 1);
    };
    return {at(view.pose.x, p.x(), view.window.x, view.window.width),
            at(view.pose.y, p.y(), view.window.y, view.window.height)};
  }
  Eigen::Vector2d position(int column, int row) const {
    return {(column + view.window.x - view.pose.x) / scale, (row + view.window.y - view.pose.y) / scale};
  }
};

inline Eigen::Vector3d rotation_of(const TrainingView& view) {
  return {view.pose.rx, view.pose.ry, view.pose.rz};
}

inline std::array<float, 4> to_floats(const Eigen::Vector4d& v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2]),
          static_cast<float>(v[3])};
}

}  // namespace sextant
