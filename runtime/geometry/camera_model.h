// SPDX-License-Identifier: Apache-2.0
// Cameras: the calibrated one that the sensor has (fx != fy, lens distortion), and the ideal one with a
// single focal length into which every frame is rectified before the search (METHOD.md section 1).
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>

namespace sextant {

/// Ideal pinhole camera, square pixels, no distortion. Pixel centres lie at integer coordinates.
struct PinholeCamera {
  int width = 0;
  int height = 0;
  double focal = 0;  ///< pixels
  double cx = 0;     ///< pixels
  double cy = 0;     ///< pixels

  /// Tangent coordinates (X/Z, Y/Z) of pixel (x, y).
  Eigen::Vector2d tangent(double x, double y) const { return {(x - cx) / focal, (y - cy) / focal}; }
  /// Unit vector from the focal point through pixel (x, y), camera frame.
  Eigen::Vector3d ray(double x, double y) const {
    return Eigen::Vector3d((x - cx) / focal, (y - cy) / focal, 1.0).normalized();
  }
  /// Pixel of a point in the camera frame, metres. The point must have Z > 0.
  Eigen::Vector2d project(const Eigen::Vector3d& p_in_camera) const {
    return {cx + focal * p_in_camera.x() / p_in_camera.z(), cy + focal * p_in_camera.y() / p_in_camera.z()};
  }
};

/// Calibrated camera: OpenCV's pinhole model with Brown-Conrady distortion (k1 k2 p1 p2 k3 k4 k5 k6).
struct CameraModel {
  int width = 0;
  int height = 0;
  double fx = 0, fy = 0, cx = 0, cy = 0;  ///< pixels
  std::array<double, 8> distortion{};     ///< all zero: none

  bool has_distortion() const;
  /// True where pixels are already those of a PinholeCamera (fx == fy, no distortion).
  bool is_ideal() const;
  /// Tangent coordinates of a pixel, distortion removed (iterated to 1e-10 or 50 rounds).
  Eigen::Vector2d undistorted_tangent(double x, double y) const;
  /// Pixel of tangent coordinates, distortion applied.
  Eigen::Vector2d distorted_pixel(const Eigen::Vector2d& tangent) const;
  /// The ideal camera that covers about the same view: focal = sqrt(fx fy) * width_out / width.
  /// width_out 0 keeps the size.
  PinholeCamera ideal(int width_out = 0) const;
  /// Throws InputError(where) unless sizes are 16..16384, focals finite and positive, the centre in a sane
  /// place.
  void check(const std::string& where) const;
};

}  // namespace sextant
