// SPDX-License-Identifier: Apache-2.0
// One synthetic training image of a bin (Davies 2015, Proc. 1): random pose in the bin and the camera's
// frustum, random light; rendered only in the square around the projected bounding sphere.
#pragma once

#include <opencv2/core.hpp>
#include <random>

#include "offline/learn/parameters.h"
#include "offline/render/renderer.h"
#include "runtime/geometry/pose6.h"
#include "runtime/model/object_model.h"

namespace sextant {

struct TrainingView {
  Pose6 pose;
  cv::Rect window;      ///< of the camera's image, may reach outside of it
  cv::Mat edges;        ///< edges_by_direction of the window
  cv::Mat ray_depth_m;  ///< CV_32FC1 of the window, 0 = background
};

/// A seeded source of training views of one object in one bin.
class TrainingViews {
 public:
  /// mesh: handle in `renderer` of a mesh in the object frame.
  TrainingViews(Renderer& renderer, int mesh, double bounding_radius_m, const LearnParameters& parameters,
                const RotationBox& box, std::uint64_t seed);
  TrainingView next();

 private:
  double uniform(double lo, double hi);
  Pose6 random_pose();

  Renderer& renderer_;
  int mesh_;
  double radius_m_;
  const LearnParameters& parameters_;
  RotationBox box_;
  std::mt19937_64 random_;
};

}  // namespace sextant
