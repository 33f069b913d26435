// SPDX-License-Identifier: Apache-2.0
#include "offline/report/silhouette.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <vector>

namespace sextant {
namespace {

constexpr double kNearestM = 0.02;
constexpr int kSubpixelBits = 4;
constexpr double kFarPixel = 1e5;  ///< beyond any image; keeps the fixed-point coordinates from overflowing

}  // namespace

std::optional<cv::Point2d> project_scaled(const CameraModel& camera, const Eigen::Vector3d& p_in_camera,
                                          int scale) {
  if (!(p_in_camera.z() >= kNearestM)) return std::nullopt;
  const Eigen::Vector2d pixel = camera.distorted_pixel(p_in_camera.head<2>() / p_in_camera.z());
  const Eigen::Vector2d scaled = (pixel.array() + 0.5) * scale - 0.5;
  if (!scaled.allFinite()) return std::nullopt;
  return cv::Point2d(std::clamp(scaled.x(), -kFarPixel, kFarPixel),
                     std::clamp(scaled.y(), -kFarPixel, kFarPixel));
}

cv::Mat silhouette_mask(const ModelMesh& mesh, const CameraModel& camera,
                        const RigidTransform& camera_from_model, int scale) {
  cv::Mat mask = cv::Mat::zeros(camera.height * scale, camera.width * scale, CV_8UC1);
  std::vector<std::optional<cv::Point2d>> pixels;
  pixels.reserve(mesh.vertices.size());
  for (const Eigen::Vector3f& vertex : mesh.vertices) {
    pixels.push_back(project_scaled(camera, camera_from_model * vertex.cast<double>(), scale));
  }
  for (const auto& triangle : mesh.triangles) {
    std::array<cv::Point, 3> corners;
    bool visible = true;
    for (std::size_t i = 0; i < 3 && visible; ++i) {
      if (triangle[i] >= pixels.size())
        throw std::invalid_argument("a triangle names a vertex that is not there");
      const std::optional<cv::Point2d>& pixel = pixels[triangle[i]];
      visible = pixel.has_value();
      if (visible) {
        corners[i] = cv::Point(static_cast<int>(std::lround(pixel->x * (1 << kSubpixelBits))),
                               static_cast<int>(std::lround(pixel->y * (1 << kSubpixelBits))));
      }
    }
    if (visible) cv::fillConvexPoly(mask, corners.data(), 3, cv::Scalar(255), cv::LINE_8, kSubpixelBits);
  }
  return mask;
}

}  // namespace sextant
