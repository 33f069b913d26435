// SPDX-License-Identifier: Apache-2.0
// What the refinement of one lattice pose found out: how far it went, and how well the rigid model explains
// the picture there. The confidence is computed from these shares.
#pragma once

namespace sextant {

struct Refinement {
  bool refined = false;  ///< the pose is the continuous optimum; false: it is still the lattice pose
  /// The optimum lies outside of the neighbourhood of the certified lattice pose (Refiner::kMaxShiftM,
  /// kMaxTurnRad): the lattice pose is kept, and this says so.
  bool left_neighbourhood = false;
  /// The lattice optimum is turned another way about the vertical: this pose scores less (by the gap), but
  /// the rigid model explains the picture better.
  bool other_turn = false;
  double shift_m = 0;   ///< of the object's centre from the lattice pose to the continuous optimum
  double turn_rad = 0;  ///< angle between both orientations
  // Shares of the depth pixels of the object's picture. They add up to 1.
  double depth_inlier_share = 0;  ///< on the surface, within the sensor's noise
  double off_surface_share = 0;   ///< elsewhere, mostly farther than the surface: speaks against the pose
  double occluded_share = 0;      ///< nearer than the surface: something stands before it
  double missing_share = 0;       ///< no depth: unknown
  double depth_rms_m = 0;         ///< of the inliers, along the ray
  // Of the edge samples that nothing hides:
  double edge_inlier_share = 0;     ///< with an edge of their direction within 2 pixels (f = 525)
  double outline_inlier_share = 0;  ///< the same of the silhouette's samples alone
  double mark_inlier_share = 0;     ///< the same of the print's marks alone; 0.5 where fewer than 20 are seen
  double edge_rms_px = 0;           ///< of those, pixels of the searched image
  int depth_samples = 0;            ///< pixels looked at
  int edge_samples = 0;             ///< unhidden samples looked at
};

}  // namespace sextant
