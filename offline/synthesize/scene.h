// SPDX-License-Identifier: Apache-2.0
// A room with a table in it: where camera, light, targets and clutter are. World frame: z up, the table's top
// is z = 0, the camera stands at (0, 0, height) and looks towards +y.
#pragma once

#include <vector>

#include "offline/mesh/mesh.h"
#include "offline/synthesize/random.h"
#include "runtime/geometry/camera_model.h"
#include "runtime/geometry/rigid_transform.h"
#include "runtime/geometry/table_geometry.h"

namespace sextant {

/// What scenes may look like.
struct SceneOptions {
  PinholeCamera camera{640, 480, 525, 319.5, 239.5};
  Range pitch_deg{30, 50};  ///< looking down positive, 5..85
  Range roll_deg{-3, 3};
  Range height_m{0.5, 0.85};   ///< of the camera above the table
  Range distance_m{0.5, 1.3};  ///< from the camera to the target's centre
  Range clutter{4, 9};         ///< number of shapes beside the targets
  double min_visible = 0.5;    ///< share of the target's silhouette that must be seen
};

/// What the composer must know of an object that is to stand on the table.
struct Footprint {
  double bounding_radius_m = 0;    ///< about the object frame's origin
  double horizontal_radius_m = 0;  ///< about its vertical axis
  double centre_height_m = 0;      ///< of the origin above the table
};

struct PlacedMesh {
  Mesh mesh;
  RigidTransform world_from_mesh = RigidTransform::Identity();
};

struct TableScene {
  TableGeometry table;
  RigidTransform camera_from_world = RigidTransform::Identity();
  std::vector<RigidTransform> world_from_target;  ///< object frames, one per footprint
  std::vector<PlacedMesh> surroundings;           ///< table, floor, walls, clutter
  Eigen::Vector3d light_in_world{0, 0, 2};
  double ambient = 0.5;
};

/// Axes of the camera over the table.
RigidTransform camera_from_world(double pitch_rad, double roll_rad, double height_m);

/// Composes a scene. Targets are wholly inside the picture, stand on the table upright at random turntable
/// angles and touch neither each other nor clutter (whose footprints are discs). Throws UsageError where no
/// place for the targets was found within the options.
TableScene compose_scene(const SceneOptions& options, const std::vector<Footprint>& targets, Random& random);

}  // namespace sextant
