// SPDX-License-Identifier: Apache-2.0
#include "offline/synthesize/lighting.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace sextant {
namespace {

constexpr int kMapSize = 1024;
constexpr double kBiasM = 0.006;  ///< a surface must not shade itself

/// A camera frame at the light that looks at the focus.
RigidTransform light_from_camera(const Eigen::Vector3d& light, const Eigen::Vector3d& focus) {
  const Eigen::Vector3d forward = (focus - light).normalized();
  const Eigen::Vector3d helper =
      std::abs(forward.x()) < 0.9 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY();
  RigidTransform camera_from_light = RigidTransform::Identity();
  camera_from_light.linear().col(2) = forward;
  camera_from_light.linear().col(0) = helper.cross(forward).normalized();
  camera_from_light.linear().col(1) = forward.cross(camera_from_light.linear().col(0));
  camera_from_light.translation() = light;
  return camera_from_light.inverse();
}

/// Share of the map's pixels around (x, y) that see something nearer to the light than `distance`.
double shaded_share(const cv::Mat& map, int x, int y, double distance, int softness) {
  int shaded = 0;
  int count = 0;
  for (int dy = -softness; dy <= softness; ++dy) {
    for (int dx = -softness; dx <= softness; ++dx) {
      if (x + dx < 0 || y + dy < 0 || x + dx >= map.cols || y + dy >= map.rows) continue;
      const float seen = map.at<float>(y + dy, x + dx);
      ++count;
      if (seen > 0 && seen < distance - kBiasM * (1 + std::max(std::abs(dx), std::abs(dy)))) ++shaded;
    }
  }
  return count > 0 ? static_cast<double>(shaded) / count : 0;
}

}  // namespace

RenderedView render_with_shadows(Renderer& renderer, const PinholeCamera& camera,
                                 const std::vector<RenderItem>& items, const Light& light,
                                 const Eigen::Vector3d& background, const Eigen::Vector3d& focus_in_camera,
                                 double radius_m, int softness_px) {
  const cv::Rect window(0, 0, camera.width, camera.height);
  RenderedView view = renderer.render(camera, window, items, light, background);
  Light without = light;
  without.strength = 0;
  const cv::Mat unlit = renderer.render_colour(camera, window, items, without, background);

  const RigidTransform from_camera = light_from_camera(light.position_in_camera, focus_in_camera);
  const double distance = (focus_in_camera - light.position_in_camera).norm();
  PinholeCamera eye{kMapSize, kMapSize, 0, (kMapSize - 1) / 2.0, (kMapSize - 1) / 2.0};
  eye.focal = kMapSize / 2.0 * distance / radius_m;
  std::vector<RenderItem> seen_from_light = items;
  for (RenderItem& item : seen_from_light) item.camera_from_mesh = from_camera * item.camera_from_mesh;
  const cv::Mat map = renderer.render_geometry(eye, {0, 0, kMapSize, kMapSize}, seen_from_light).ray_depth_m;

  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const double d = view.ray_depth_m.at<float>(y, x);
      if (d <= 0) continue;
      const Eigen::Vector3d p = from_camera * Eigen::Vector3d(camera.ray(x, y) * d);
      if (p.z() <= 0.05) continue;
      const Eigen::Vector2d pixel = eye.project(p);
      if (!(pixel.minCoeff() >= 0 && pixel.maxCoeff() <= kMapSize - 1)) continue;
      const double share = shaded_share(map, static_cast<int>(std::lround(pixel.x())),
                                        static_cast<int>(std::lround(pixel.y())), p.norm(), softness_px);
      cv::Vec3b& colour = view.colour.at<cv::Vec3b>(y, x);
      if (share <= 0) continue;
      const cv::Vec3b& dark = unlit.at<cv::Vec3b>(y, x);
      for (int c = 0; c < 3; ++c)
        colour[c] = cv::saturate_cast<unsigned char>((1 - share) * colour[c] + share * dark[c]);
    }
  }
  return view;
}

}  // namespace sextant
