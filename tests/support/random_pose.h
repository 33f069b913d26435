// SPDX-License-Identifier: Apache-2.0
// Uniform random rotations and rigid transforms for property tests.
#pragma once

#include <random>

#include "runtime/geometry/rigid_transform.h"

namespace sextant {

inline Eigen::Matrix3d random_rotation(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  return Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
      .normalized()
      .matrix();
}

/// Translation within +-range_m in x and y, 0.3 .. 0.3 + range_m in z.
inline RigidTransform random_pose(std::mt19937_64& random, double range_m = 1) {
  std::uniform_real_distribution<double> unit(-1, 1);
  RigidTransform t = RigidTransform::Identity();
  t.linear() = random_rotation(random);
  t.translation() = Eigen::Vector3d(range_m * unit(random), range_m * unit(random),
                                    0.3 + range_m * (0.5 + 0.5 * unit(random)));
  return t;
}

}  // namespace sextant
