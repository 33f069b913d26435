// SPDX-License-Identifier: Apache-2.0
// A room with a table in it: where camera, lights, targets and clutter are. World frame: z up, the table's
// top is z = 0, the camera stands at (0, 0, height) and looks towards +y.
#pragma once

#include <vector>

#include "offline/synthesize/clutter.h"
#include "runtime/geometry/camera_model.h"
#include "runtime/geometry/table_geometry.h"

namespace sextant {

/// What scenes may look like.
struct SceneOptions {
  PinholeCamera camera{640, 480, 525, 319.5, 239.5};
  Range pitch_deg{30, 50};  ///< looking down positive, 5..85
  Range roll_deg{-3, 3};
  Range height_m{0.5, 0.85};      ///< of the camera above the table
  Range distance_m{0.5, 1.3};     ///< from the camera to the target's centre
  Range clutter{4, 9};            ///< number of things beside the targets
  Range occlusion{0, 0.5};        ///< share of each target's silhouette in the image that others hide
  double cut_share = 0;           ///< of the targets that the image's border cuts
  double cut_visible = 0.6;       ///< of such a target's silhouette lies in the image at least
  double decoy_share = 0.2;       ///< of the clutter that has a target's size and another print
  double distractor_share = 0.3;  ///< of the clutter that is one of the named meshes, where there are any
};

struct PlacedMesh {
  Mesh mesh;
  RigidTransform world_from_mesh = RigidTransform::Identity();
  int distractor = -1;  ///< index into the named meshes; -1: `mesh`
  double gloss = 0;
};

struct SceneLight {
  Eigen::Vector3d p_in_world{0, 0, 2};
  double strength = 0;
};

struct TableScene {
  TableGeometry table;
  RigidTransform camera_from_world = RigidTransform::Identity();
  TableTop top;
  std::vector<RigidTransform> world_from_target;  ///< object frames, one per footprint
  std::vector<bool> cut;                          ///< whether the target was put at the border
  std::vector<PlacedMesh> surroundings;           ///< room first, then clutter
  std::size_t first_clutter = 0;                  ///< index into surroundings
  std::vector<Disc> taken;                        ///< places on the table: targets, then clutter
  Eigen::Vector3d light_in_world{0, 0, 2};
  double ambient = 0.5;
  std::vector<SceneLight> fills;
};

/// Axes of the camera over the table.
RigidTransform camera_from_world(double pitch_rad, double roll_rad, double height_m);

/// Composes a scene. Targets are wholly inside the picture (but for those that the border shall cut), stand
/// on the table upright at random turntable angles and touch neither each other nor clutter (whose footprints
/// are discs). Without targets: a negative. Throws UsageError where no place for the targets was found within
/// the options.
TableScene compose_scene(const SceneOptions& options, const std::vector<Footprint>& targets,
                         const ClutterStock& stock, Random& random);

/// Puts a thing between the camera and a target so that it hides about the share `hidden` of it: a column
/// that covers one side, or a low wall that covers the lower part. False where there is no room for it.
bool add_occluder(TableScene& scene, std::size_t target, const Footprint& footprint, double hidden,
                  const ClutterStock& stock, Random& random);
/// Takes a thing of the clutter away (index into surroundings, not below first_clutter).
void remove_clutter(TableScene& scene, std::size_t index);

}  // namespace sextant
