// SPDX-License-Identifier: Apache-2.0
// The part of the view that a user cares about, in the user's terms: pixels of the camera's own image, metres
// of the table's or the robot's frame.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "runtime/search/search_region.h"

namespace sextant {

struct RegionOfInterest {
  std::optional<std::array<double, 4>> image;      ///< x, y, width, height; for projected centres
  std::optional<std::array<double, 6>> workspace;  ///< x0 x1 y0 y1 z0 z1, metres; for centres
  /// Frame of the workspace; empty: the table's (see table_from_camera), which then must be known.
  std::optional<RigidTransform> workspace_from_camera;

  bool operator==(const RegionOfInterest& other) const;
};

/// From text: "X Y WIDTH HEIGHT", "X0 X1 Y0 Y1 Z0 Z1" and "X Y Z QX QY QZ QW" (the camera's pose in the
/// workspace's frame); "" where there is none. Throws UsageError naming what is wrong.
RegionOfInterest region_from_text(const std::string& image, const std::string& workspace,
                                  const std::string& workspace_from_camera);

/// For one frame. Throws InputError where the rectangle lies outside of the image, and where the workspace is
/// in the table's frame and no table is known.
SearchRegion search_region(const RegionOfInterest& region, const CameraModel& camera,
                           const PinholeCamera& ideal, const std::optional<TableGeometry>& table);

}  // namespace sextant
