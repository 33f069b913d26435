// SPDX-License-Identifier: Apache-2.0
// A ball of poses around one pose: those whose centre is near and whose orientation is similar, up to the
// object's symmetry. What lies outside of the balls around the answers is a different explanation of the
// image.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "runtime/geometry/camera_model.h"
#include "runtime/geometry/rigid_transform.h"
#include "runtime/search/lattice.h"

namespace sextant {

/// How large a ball is, and which turns about the object's vertical look the same.
struct BallSize {
  double radius_m = 0.03;              ///< of positions, >= 0
  double angle_rad = 30 * kOneDegree;  ///< of orientations, 0..pi
  int symmetry_deg = 360;              ///< 0: round; else 360 / symmetry_deg turns look alike
};

class PoseBall {
 public:
  PoseBall(const PinholeCamera& camera, const LatticePose& centre, const BallSize& size);
  /// Both the distance of the centres and the angle between the orientations are within the size.
  bool contains(const LatticePose& pose) const;
  /// True only if contains() is true for every pose of the region; rounds towards false.
  bool contains_all(const Region& region) const;

 private:
  double angle_to(const Eigen::Matrix3d& rotation) const;

  PinholeCamera camera_;
  BallSize size_;
  Eigen::Vector3d centre_;                            ///< in the camera, metres
  std::vector<Eigen::Matrix3d> orientations_;         ///< that look alike; one where the object is round
  double x_lo_ = 0, x_hi_ = 0, y_lo_ = 0, y_hi_ = 0;  ///< pixels; no pose of the ball is outside
};

}  // namespace sextant
