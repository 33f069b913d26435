// SPDX-License-Identifier: Apache-2.0
#include "offline/synthesize/visibility.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>

namespace sextant {

Visibility measure_visibility(Renderer& renderer, const PinholeCamera& camera,
                              const std::vector<RenderItem>& items, std::size_t index,
                              double bounding_radius_m, const RenderedView& scene) {
  Visibility result;
  const Eigen::Vector3d centre = items[index].camera_from_mesh.translation();
  if (centre.z() <= 1.5 * bounding_radius_m) return result;
  const Eigen::Vector2d pixel = camera.project(centre);
  // A sphere's projection is a little larger than focal * radius / depth, more so off the axis.
  const double reach = 1.3 * camera.focal * bounding_radius_m / (centre.z() - bounding_radius_m) + 2;
  const int left = static_cast<int>(std::floor(pixel.x() - reach));
  const int top = static_cast<int>(std::floor(pixel.y() - reach));
  const int side = static_cast<int>(std::ceil(2 * reach)) + 1;
  const cv::Mat alone = renderer.render_geometry(camera, {left, top, side, side}, {items[index]}).item;
  const auto own = static_cast<std::int16_t>(index);
  const cv::Rect picture(0, 0, camera.width, camera.height);
  std::map<int, int> hidden_by;
  cv::Point low(1 << 20, 1 << 20);
  cv::Point high(-1, -1);
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      if (alone.at<std::int16_t>(y, x) != 0) continue;
      ++result.all;
      const cv::Point p(left + x, top + y);
      if (!picture.contains(p)) continue;
      ++result.inside;
      const std::int16_t seen = scene.item.at<std::int16_t>(p);
      if (seen != own) {
        ++hidden_by[seen];
        continue;
      }
      ++result.visible;
      low = {std::min(low.x, p.x), std::min(low.y, p.y)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
  }
  result.box_all = cv::boundingRect(alone == 0) + cv::Point(left, top);
  if (result.visible > 0) result.box_visible = {low, high + cv::Point(1, 1)};
  int most = 0;
  for (const auto& [item, count] : hidden_by) {
    if (count <= most) continue;
    most = count;
    result.worst_hider = item;
  }
  return result;
}

}  // namespace sextant
