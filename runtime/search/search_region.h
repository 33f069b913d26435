// SPDX-License-Identifier: Apache-2.0
// A part of the space of poses: those whose centre projects into a rectangle of the image, or lies in a box
// of the workspace. The restriction is exact: the answer is the best pose of the part, while the frame's
// tables still see everything around it.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "runtime/geometry/camera_model.h"
#include "runtime/geometry/interval.h"
#include "runtime/geometry/rigid_transform.h"
#include "runtime/geometry/table_geometry.h"

namespace sextant {

/// Closed ranges of pixels of the image that is searched.
struct PixelRectangle {
  int x0 = 0, y0 = 0, x1 = -1, y1 = -1;
};

/// A box along the axes of a frame of the workspace, for the centres of objects.
struct WorkspaceBox {
  RigidTransform workspace_from_camera = RigidTransform::Identity();
  Eigen::Vector3d lo{0, 0, 0}, hi{0, 0, 0};  ///< metres, closed

  bool contains(const Eigen::Vector3d& p_in_camera) const;
  /// Distances (metres, along the ray) at which a point over a rectangle of pixel positions can lie in the
  /// box. Never loses one; empty (lo > hi) where no ray meets the box.
  Interval distances_over(const PinholeCamera& camera, Interval x, Interval y) const;
};

struct SearchRegion {
  std::optional<PixelRectangle> image;
  std::optional<WorkspaceBox> workspace;
};

/// The frame on the table that TableEstimate messages use: origin straight below the camera, z up, x where
/// the camera looks (to the image's top, where it looks straight down).
RigidTransform table_from_camera(const TableGeometry& table);

/// The pixels of `ideal` at which `camera` (what `ideal` was made from) sees the rectangle x, y, width,
/// height of its own image: the smallest rectangle that holds the border's pixels.
PixelRectangle rectified_rectangle(const CameraModel& camera, const PinholeCamera& ideal, double x, double y,
                                   double width, double height);

}  // namespace sextant
