// SPDX-License-Identifier: Apache-2.0
#include "offline/report/model_sheet/shaded_mesh.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace sextant {
namespace {

constexpr double kNearestM = 1e-3;

/// Grey of a face: ambient plus Lambert from one far light; the side towards the camera is the lit one.
double grey_of(Eigen::Vector3d normal, const Eigen::Vector3d& centre) {
  static const Eigen::Vector3d kToLight = Eigen::Vector3d(-0.35, -0.55, -0.75).normalized();
  if (normal.dot(centre) > 0) normal = -normal;
  return 60 + 150 * std::max(0.0, normal.dot(kToLight));
}

/// Paints the pixels whose centres lie in the triangle, where it is nearer than what is there. The inverse of
/// the axial depth is linear in the image.
void paint(const std::array<Eigen::Vector2d, 3>& pixel, const Eigen::Vector3d& inverse_depth, double grey,
           cv::Mat1f& nearness, cv::Mat& image) {
  const Eigen::Vector2d lo = pixel[0].cwiseMin(pixel[1]).cwiseMin(pixel[2]);
  const Eigen::Vector2d hi = pixel[0].cwiseMax(pixel[1]).cwiseMax(pixel[2]);
  const auto first = [](double from) { return static_cast<int>(std::ceil(std::max(from, 0.0))); };
  const auto last = [](double to, int size) {
    return static_cast<int>(std::floor(std::min(to, size - 1.0)));
  };
  Eigen::Matrix3d corners;
  for (int i = 0; i < 3; ++i) corners.col(i) = pixel[static_cast<std::size_t>(i)].homogeneous();
  if (!(std::abs(corners.determinant()) > 1e-9)) return;
  const Eigen::Matrix3d weights_from_pixel = corners.inverse();
  const auto value = static_cast<std::uint8_t>(std::lround(std::clamp(grey, 0.0, 255.0)));
  for (int y = first(lo.y()); y <= last(hi.y(), image.rows); ++y) {
    for (int x = first(lo.x()); x <= last(hi.x(), image.cols); ++x) {
      const Eigen::Vector3d weights = weights_from_pixel * Eigen::Vector3d(x, y, 1);
      if (!(weights.minCoeff() >= -1e-9)) continue;
      const auto near = static_cast<float>(weights.dot(inverse_depth));
      if (near <= nearness(y, x)) continue;
      nearness(y, x) = near;
      image.at<cv::Vec3b>(y, x) = cv::Vec3b::all(value);
    }
  }
}

}  // namespace

void draw_shaded_mesh(const ModelMesh& mesh, const PinholeCamera& camera,
                      const RigidTransform& camera_from_object, cv::Mat& image) {
  std::vector<Eigen::Vector3d> points;
  points.reserve(mesh.vertices.size());
  for (const Eigen::Vector3f& v : mesh.vertices) points.push_back(camera_from_object * v.cast<double>());
  cv::Mat1f nearness(image.size(), 0.0F);
  for (const auto& triangle : mesh.triangles) {
    const std::array<Eigen::Vector3d, 3> p{points[triangle[0]], points[triangle[1]], points[triangle[2]]};
    if (!(std::min({p[0].z(), p[1].z(), p[2].z()}) > kNearestM)) continue;
    const Eigen::Vector3d normal = (p[1] - p[0]).cross(p[2] - p[0]).normalized();
    const double grey = grey_of(normal, p[0] + p[1] + p[2]);
    paint({camera.project(p[0]), camera.project(p[1]), camera.project(p[2])},
          {1 / p[0].z(), 1 / p[1].z(), 1 / p[2].z()}, grey, nearness, image);
  }
}

}  // namespace sextant
