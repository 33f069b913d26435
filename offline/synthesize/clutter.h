// SPDX-License-Identifier: Apache-2.0
// The things that stand around the targets: plain shapes, printed packages, decoys of a target's size, and
// meshes that the user names.
#pragma once

#include <vector>

#include "offline/mesh/mesh.h"
#include "offline/synthesize/random.h"
#include "offline/synthesize/texture_library.h"
#include "runtime/geometry/rigid_transform.h"

namespace sextant {

/// What the composer must know of an object that is to stand on the table.
struct Footprint {
  double bounding_radius_m = 0;           ///< about the object frame's origin
  double horizontal_radius_m = 0;         ///< about its vertical axis
  double centre_height_m = 0;             ///< of the origin above the table
  Eigen::Vector3d size_m{0.1, 0.1, 0.1};  ///< of the box around it, object axes
};

/// A disc on the table.
struct Disc {
  Eigen::Vector2d centre{0, 0};  ///< metres, world
  double radius = 0;
};

/// Air between neighbours, metres.
inline constexpr double kClutterGapM = 0.008;

bool free_of(const Disc& disc, const std::vector<Disc>& others);

/// The table's top: a rectangle, turned about the vertical.
struct TableTop {
  Eigen::Vector2d centre{0, 0};
  Eigen::Vector2d size{1, 1};
  double yaw_rad = 0;

  bool holds(const Disc& disc) const;
};

/// Something to put on the table: its own mesh, or one of the named ones.
struct ClutterThing {
  Mesh mesh;
  int distractor = -1;  ///< index into the named meshes; -1: `mesh`
  double radius_m = 0;  ///< of its footprint
  double lift_m = 0;    ///< of the mesh's origin above the table
  double gloss = 0;
};

/// What clutter may be.
struct ClutterStock {
  TextureLibrary& textures;
  const std::vector<Footprint>& targets;      ///< decoys take their size
  const std::vector<Footprint>& distractors;  ///< the named meshes
  double decoy_share = 0;
  double distractor_share = 0;
};

/// A random thing of about a hand's size.
ClutterThing random_clutter(const ClutterStock& stock, Random& random);
/// An upright thing of about this radius and height (metres), to hide a part of something else.
ClutterThing random_occluder(const ClutterStock& stock, double radius_m, double height_m, Random& random);

RigidTransform standing_at(const Eigen::Vector2d& place, double z, double yaw_rad);

}  // namespace sextant
