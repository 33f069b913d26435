// SPDX-License-Identifier: Apache-2.0
// Small scenes in which learnt parts are put to the test: the object (or something else) on a textured table
// among clutter, seen by a real sensor. Only the square around the hypothesis is rendered.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

#include "offline/learn/parameters.h"
#include "offline/learn/scenery.h"
#include "offline/render/renderer.h"
#include "runtime/geometry/pose6.h"
#include "runtime/model/object_model.h"

namespace sextant {

/// What is really there where the hypothesis claims the object in this bin.
enum class SceneTruth : std::uint8_t {
  kObject,        ///< the object as claimed
  kTurnedObject,  ///< the object, turned to another side
  kClutter,       ///< something else
};

struct SceneView {
  Pose6 hypothesis;     ///< in the bin
  cv::Rect window;      ///< of the camera's image, may reach outside of it
  cv::Mat edges;        ///< edges_by_direction of the window
  cv::Mat ray_depth_m;  ///< CV_32FC1, as the sensor sees it; 0 = missing
};

/// A seeded source of scenes of one object in one bin.
class SceneViews {
 public:
  /// mesh: handle in `renderer` of a mesh in the object frame. symmetry_deg: turned by so much the object
  /// looks the same; 0: by any angle, and then turned objects are not to be asked for.
  SceneViews(Renderer& renderer, const Scenery& scenery, int mesh, double bounding_radius_m,
             double centre_height_m, int symmetry_deg, const LearnParameters& parameters,
             const RotationBox& box, std::uint64_t seed);
  SceneView next(SceneTruth truth);

 private:
  void add_surroundings(const RigidTransform& camera_from_foot, SceneTruth truth,
                        std::vector<RenderItem>& items);

  Renderer& renderer_;
  const Scenery& scenery_;
  int mesh_;
  double radius_m_;
  double centre_height_m_;
  int symmetry_deg_;
  const LearnParameters& parameters_;
  RotationBox box_;
  Random random_;
};

}  // namespace sextant
