// SPDX-License-Identifier: Apache-2.0
// The feasible set (METHOD.md section 6): the lattice poses of a bin whose centre lies in the image and the
// range of distances and, where a table is known, which stand on it (Davies 2015, Procs. 21-28).
#pragma once

#include <optional>

#include "runtime/geometry/table_geometry.h"
#include "runtime/model/object_model.h"
#include "runtime/search/lattice.h"

namespace sextant {

/// Table constraint of one object.
struct TableConstraint {
  TableGeometry table;
  TableTolerance tolerance;
  double centre_height_m = 0;  ///< of the object's centre above the table
};

/// What poses are allowed in one frame for one object.
class Constraint {
 public:
  Constraint(const PinholeCamera& camera, double min_distance_m, double max_distance_m,
             std::optional<TableConstraint> table)
      : camera_(camera), min_distance_m_(min_distance_m), max_distance_m_(max_distance_m), table_(table) {}

  /// All lattice poses of a bin before the table constraint.
  Region whole(int bin_index, const RotationBox& box) const;
  /// CONSTRAINT-CONTAINS (Proc. 21), z included. The pose is one of whole().
  bool contains(const LatticePose& pose) const;
  /// CONSTRAINT-INTERSECT (Proc. 28): shrinks z, rx, ry to what the table allows over the region's pixels.
  /// Never loses a feasible pose; may become empty().
  Region tightened(Region region) const;
  /// Share of the feasible (pixel, rx, ry), sampled on a fixed grid, that lies in one of the boxes; 1 without
  /// a table. Poses in no box are never found: the caller reports this.
  double coverage(const std::vector<ViewpointBin>& bins) const;

 private:
  PinholeCamera camera_;
  double min_distance_m_;
  double max_distance_m_;
  std::optional<TableConstraint> table_;
};

}  // namespace sextant
