// SPDX-License-Identifier: Apache-2.0
// One synthetic training image of a bin (Davies 2015, Proc. 1): random pose in the bin and the camera's
// frustum, random light; rendered only in the square around the projected bounding sphere. Ours: the object
// stands on a plain table, so that what is seen beside it can be learnt too.
#pragma once

#include <opencv2/core.hpp>

#include "offline/learn/parameters.h"
#include "offline/learn/scenery.h"
#include "offline/render/renderer.h"
#include "runtime/geometry/pose6.h"
#include "runtime/model/object_model.h"

namespace sextant {

struct TrainingView {
  Pose6 pose;
  cv::Rect window;        ///< of the camera's image, may reach outside of it
  cv::Mat edges;          ///< edges_by_direction of the window
  cv::Mat ray_depth_m;    ///< CV_32FC1 of the window, of the object; 0 where it is not seen
  cv::Mat table_depth_m;  ///< the same of the table; 0 where it is not seen
};

/// A seeded source of training views of one object in one bin.
class TrainingViews {
 public:
  /// mesh: handle in `renderer` of a mesh in the object frame.
  TrainingViews(Renderer& renderer, const Scenery& scenery, int mesh, double bounding_radius_m,
                double centre_height_m, const LearnParameters& parameters, const RotationBox& box,
                std::uint64_t seed);
  TrainingView next();

 private:
  Renderer& renderer_;
  const Scenery& scenery_;
  int mesh_;
  double radius_m_;
  double centre_height_m_;
  const LearnParameters& parameters_;
  RotationBox box_;
  Random random_;
};

}  // namespace sextant
