// SPDX-License-Identifier: Apache-2.0
#include "runtime/detect/outline_box.h"

#include <algorithm>
#include <limits>

namespace sextant {

std::array<double, 4> outline_box(const ObjectModel& model, const CameraModel& camera,
                                  const RigidTransform& camera_from_object) {
  double x0 = std::numeric_limits<double>::infinity();
  double y0 = x0;
  double x1 = -x0;
  double y1 = -x0;
  for (const Eigen::Vector3f& v : model.mesh.vertices) {
    const Eigen::Vector3d p = camera_from_object * v.cast<double>();
    if (p.z() <= 1e-3) continue;
    const Eigen::Vector2d pixel = camera.distorted_pixel({p.x() / p.z(), p.y() / p.z()});
    x0 = std::min(x0, pixel.x());
    x1 = std::max(x1, pixel.x());
    y0 = std::min(y0, pixel.y());
    y1 = std::max(y1, pixel.y());
  }
  if (x0 > x1) return {};
  return {x0, y0, x1 - x0, y1 - y0};
}

}  // namespace sextant
