// SPDX-License-Identifier: Apache-2.0
#include "runtime/geometry/camera_model.h"

#include <algorithm>
#include <cmath>

#include "runtime/base/error.h"

namespace sextant {

bool CameraModel::has_distortion() const {
  return std::any_of(distortion.begin(), distortion.end(), [](double d) { return d != 0; });
}

bool CameraModel::is_ideal() const { return fx == fy && !has_distortion(); }

namespace {

/// Distorted tangent coordinates (OpenCV's rational model).
Eigen::Vector2d distorted(const std::array<double, 8>& k, const Eigen::Vector2d& t) {
  const double r2 = t.squaredNorm();
  const double radial =
      (1 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]))) / (1 + r2 * (k[5] + r2 * (k[6] + r2 * k[7])));
  const double xy = t.x() * t.y();
  return {t.x() * radial + 2 * k[2] * xy + k[3] * (r2 + 2 * t.x() * t.x()),
          t.y() * radial + k[2] * (r2 + 2 * t.y() * t.y()) + 2 * k[3] * xy};
}

}  // namespace

Eigen::Vector2d CameraModel::undistorted_tangent(double x, double y) const {
  const Eigen::Vector2d target((x - cx) / fx, (y - cy) / fy);
  if (!has_distortion()) return target;
  Eigen::Vector2d t = target;
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector2d error = distorted(distortion, t) - target;
    t -= error;
    if (error.squaredNorm() < 1e-20) break;
  }
  return t;
}

Eigen::Vector2d CameraModel::distorted_pixel(const Eigen::Vector2d& tangent) const {
  const Eigen::Vector2d t = has_distortion() ? distorted(distortion, tangent) : tangent;
  return {cx + fx * t.x(), cy + fy * t.y()};
}

PinholeCamera CameraModel::ideal(int width_out) const {
  PinholeCamera c;
  c.width = width_out > 0 ? width_out : width;
  const double scale = static_cast<double>(c.width) / width;
  c.height = std::max(1, static_cast<int>(std::lround(height * scale)));
  c.focal = (fx == fy ? fx : std::sqrt(fx * fy)) * scale;
  // Pixel centres are integers: the image spans [-0.5, width - 0.5].
  c.cx = (cx + 0.5) * scale - 0.5;
  c.cy = (cy + 0.5) * scale - 0.5;
  return c;
}

void CameraModel::check(const std::string& where) const {
  if (width < 16 || height < 16 || width > 16384 || height > 16384) {
    throw InputError(where,
                     "camera size " + std::to_string(width) + " x " + std::to_string(height) +
                         " is outside 16..16384 pixels",
                     "give the size of the images");
  }
  const bool focal_ok = std::isfinite(fx) && std::isfinite(fy) && fx > 0.1 * width && fy > 0.1 * width &&
                        fx < 100.0 * width && fy < 100.0 * width && fx / fy < 1.5 && fy / fx < 1.5;
  if (!focal_ok) {
    throw InputError(where,
                     "focal lengths " + std::to_string(fx) + ", " + std::to_string(fy) +
                         " are not those of a camera with this image size",
                     "give fx, fy in pixels from the calibration");
  }
  // A part cut out of an image may lie far from the optical axis: up to 76 degrees.
  const bool centre_ok = std::isfinite(cx) && std::isfinite(cy) && cx > -4 * fx && cx < width + 4 * fx &&
                         cy > -4 * fy && cy < height + 4 * fy;
  if (!centre_ok) {
    throw InputError(
        where,
        "the principal point " + std::to_string(cx) + ", " + std::to_string(cy) + " is far outside the image",
        "give cx, cy in pixels from the calibration");
  }
  for (const double d : distortion) {
    if (!std::isfinite(d) || std::abs(d) > 100) {
      throw InputError(where, "distortion coefficient " + std::to_string(d) + " is not usable",
                       "give OpenCV's k1 k2 p1 p2 k3 k4 k5 k6, or none");
    }
  }
}

}  // namespace sextant
