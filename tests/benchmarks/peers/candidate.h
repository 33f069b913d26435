// SPDX-License-Identifier: Apache-2.0
// What both peers do with a rough pose: refine it against the depth (OpenCV's ICP), stand it on the table,
// judge it by rendering.
#pragma once

#include <opencv2/core.hpp>

#include "tests/benchmarks/peers/peer.h"

namespace sextant {

/// Points of the scene above the table, with normals: rows of (x, y, z, nx, ny, nz), metres, camera frame.
/// low_m, high_m: heights above the table.
cv::Mat points_above_table(const RgbdFrame& frame, const PinholeCamera& camera, double low_m, double high_m,
                           int step_px);

/// Points of the object that the renderer sees in a pose, object frame, the same layout.
cv::Mat visible_points(Renderer& renderer, const PeerObject& object, const PinholeCamera& camera,
                       const RigidTransform& camera_from_object, int step_px);

/// OpenCV's point-to-plane ICP against the scene points within reach_m of the object; the pose comes back as
/// it was where there are too few.
RigidTransform refined(Renderer& renderer, const PeerObject& object, const PinholeCamera& camera,
                       const cv::Mat& scene_points, const RigidTransform& camera_from_object, double reach_m);

/// The nearest pose that stands on the table: upright, base on the plane.
RigidTransform stood_on_table(const RigidTransform& camera_from_object, const TableGeometry& table,
                              double centre_height_m);

/// How well a rendered pose agrees with the frame.
struct Agreement {
  double depth = 0;   ///< share of the silhouette's measured pixels within 1 cm
  double known = 0;   ///< share of the silhouette's pixels that have a depth
  double colour = 0;  ///< correlation of the colours over the silhouette, -1..1
};
Agreement agreement(Renderer& renderer, const PeerObject& object, const RgbdFrame& frame,
                    const PinholeCamera& camera, const RigidTransform& camera_from_object);

}  // namespace sextant
