// SPDX-License-Identifier: Apache-2.0
// A triangle mesh with its looks, as the renderer wants it.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace sextant {

/// Triangles that share one look. Vertices index into Mesh.
struct MeshPart {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  int texture = -1;                  ///< index into Mesh::textures, -1: none
  Eigen::Vector3f diffuse{1, 1, 1};  ///< multiplies vertex colour and texture, linear 0..1
};

/// A mesh in metres. All vertex arrays have the same length.
struct Mesh {
  std::vector<Eigen::Vector3f> vertices;  ///< metres
  std::vector<Eigen::Vector3f> normals;   ///< unit length
  std::vector<Eigen::Vector3f> colours;   ///< 0..1, white where the file has none
  std::vector<Eigen::Vector2f> uvs;       ///< texture coordinates, v up (OpenGL); 0 where there are none
  std::vector<MeshPart> parts;
  std::vector<cv::Mat> textures;  ///< CV_8UC3, RGB, first row = top of the image (v = 1)

  std::size_t triangle_count() const {
    std::size_t n = 0;
    for (const MeshPart& part : parts) n += part.triangles.size();
    return n;
  }
};

}  // namespace sextant
