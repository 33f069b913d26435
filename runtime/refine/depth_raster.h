// SPDX-License-Identifier: Apache-2.0
// A small z-buffer rasteriser: which triangle of a rigid mesh each pixel sees, and how far away it is. It is
// what the refinement compares the depth image with; runtime/ has no OpenGL. Scan lines with the three edges
// of a triangle as linear functions of the pixel (Pineda 1988, "A parallel algorithm for polygon
// rasterization"); the inverse of the axial depth is linear in the image.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "runtime/geometry/camera_model.h"
#include "runtime/geometry/rigid_transform.h"
#include "runtime/model/object_model.h"

namespace sextant {

/// The picture of one mesh at one pose; buffers are kept from call to call.
class DepthRaster {
 public:
  static constexpr std::int32_t kBackground = -1;

  /// Draws `mesh` into the part of the camera's image that it covers. Both sides of a triangle are drawn (the
  /// nearest surface wins, at equal depth the triangle that comes first). Triangles that reach nearer than
  /// 5 cm to the focal plane are left out. Cost: O(vertices + triangles + covered pixels).
  void draw(const ModelMesh& mesh, const RigidTransform& camera_from_object, const PinholeCamera& camera);

  /// Pixels of the image that may be covered; empty where the mesh is outside the image.
  const cv::Rect& window() const { return window_; }
  /// Number of the triangle seen at a pixel of the image, kBackground where there is none or outside.
  std::int32_t triangle(int x, int y) const { return inside(x, y) ? triangle_[index(x, y)] : kBackground; }
  /// 1 / axial depth (1/m) at a pixel of the image, 0 where nothing is seen.
  float inverse_depth(int x, int y) const { return inside(x, y) ? inverse_depth_[index(x, y)] : 0.0F; }
  /// Vertices in the camera frame, metres, of the last drawing.
  const std::vector<Eigen::Vector3f>& vertices_in_camera() const { return vertices_; }

 private:
  bool inside(int x, int y) const {
    return x >= window_.x && y >= window_.y && x < window_.x + window_.width &&
           y < window_.y + window_.height;
  }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y - window_.y) * static_cast<std::size_t>(window_.width) +
           static_cast<std::size_t>(x - window_.x);
  }
  void draw_triangle(std::int32_t number, const std::array<std::uint32_t, 3>& corners);

  cv::Rect window_;
  std::vector<Eigen::Vector3f> vertices_;   ///< camera frame
  std::vector<Eigen::Vector3f> projected_;  ///< x, y in pixels of the window, 1 / Z (0: too near)
  std::vector<float> inverse_depth_;
  std::vector<std::int32_t> triangle_;
};

}  // namespace sextant
