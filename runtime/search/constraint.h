// SPDX-License-Identifier: Apache-2.0
// The feasible set (METHOD.md section 6): the lattice poses of a bin whose centre lies in the image and the
// range of distances, in the region of interest where there is one, and which stand on the table where that
// is known (Davies 2015, Procs. 21-28).
#pragma once

#include <optional>
#include <utility>

#include "runtime/geometry/table_geometry.h"
#include "runtime/model/object_model.h"
#include "runtime/search/lattice.h"
#include "runtime/search/search_region.h"

namespace sextant {

/// Table constraint of one object.
struct TableConstraint {
  TableGeometry table;
  TableTolerance tolerance;
  double centre_height_m = 0;  ///< of the object's centre above the table
};

/// What is feasible over a rectangle of pixels. Lattice steps, closed; never loses a feasible pose.
struct CellRange {
  Interval table_distance;  ///< metres from the camera to the surface of standing centres; 0 without a table
  int offset_lo = 0, offset_hi = -1;  ///< of z from floor(table_distance / step) of the pose's own pixel
  std::int16_t rx_lo = 0, rx_hi = -1, ry_lo = 0, ry_hi = -1;
  bool empty() const { return offset_lo > offset_hi || rx_lo > rx_hi || ry_lo > ry_hi; }
};

/// What poses are allowed in one frame for one object.
class Constraint {
 public:
  Constraint(const PinholeCamera& camera, double min_distance_m, double max_distance_m,
             std::optional<TableConstraint> table, SearchRegion region = {})
      : camera_(camera),
        min_distance_m_(min_distance_m),
        max_distance_m_(max_distance_m),
        table_(std::move(table)),
        region_(std::move(region)) {}

  /// All lattice poses of a bin before the table constraint and the workspace; may be empty().
  Region whole(int bin_index, const RotationBox& box) const;
  /// CONSTRAINT-CONTAINS (Proc. 21), z included. The pose is one of whole().
  bool contains(const LatticePose& pose) const;
  /// CONSTRAINT-INTERSECT (Proc. 28): shrinks z, rx, ry to what the table allows over the region's pixels.
  /// Never loses a feasible pose; may become empty().
  Region tightened(Region region) const;
  /// The same for the pixels x0..x1, y0..y1 (those outside of the image hold no pose).
  CellRange over_cell(int x0, int y0, int x1, int y1) const;
  /// Metres to the surface of standing centres along the ray of pixel (x, y); 0 without a table or where the
  /// ray does not meet it.
  double table_distance(int x, int y) const;
  const PinholeCamera& camera() const { return camera_; }
  /// Metres; no feasible pose in the image is nearer.
  double nearest_feasible_distance() const;
  /// Lattice indices of the allowed distances.
  int nearest_index() const;
  int farthest_index() const;
  /// Share of the feasible (pixel, rx, ry), sampled on a fixed grid, that lies in one of the boxes; 1 without
  /// a table. Poses in no box are never found: the caller reports this.
  double coverage(const std::vector<ViewpointBin>& bins) const;

 private:
  /// Lattice steps of z (closed; lo > hi: none) at which the workspace is met over a rectangle of pixels.
  struct Steps {
    int lo = -32000, hi = 32000;
  };
  Steps workspace_steps(Interval x, Interval y) const;

  PinholeCamera camera_;
  double min_distance_m_;
  double max_distance_m_;
  std::optional<TableConstraint> table_;
  SearchRegion region_;
};

}  // namespace sextant
