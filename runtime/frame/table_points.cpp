// SPDX-License-Identifier: Apache-2.0
#include "runtime/frame/table_points.h"

#include <algorithm>

#include "runtime/base/error.h"

namespace sextant {
namespace {

constexpr int kColumns = 160;

/// point(x, y): of a pixel, (0, 0, 0) where it is missing.
template <typename Point>
TablePoints sample(int width, int height, Point point) {
  const int step = std::max(1, width / kColumns);
  TablePoints out;
  out.columns = (width + step - 1) / step;
  out.rows = (height + step - 1) / step;
  out.points.reserve(static_cast<std::size_t>(out.columns) * static_cast<std::size_t>(out.rows));
  for (int y = 0; y < height; y += step) {
    for (int x = 0; x < width; x += step) out.points.push_back(point(x, y));
  }
  return out;
}

}  // namespace

TablePoints table_points(const SearchFrame& frame, double farthest_m) {
  return sample(frame.camera.width, frame.camera.height, [&](int x, int y) -> Eigen::Vector3f {
    const float d = frame.ray_depth_m.at<float>(y, x);
    if (!(d > 0)) return Eigen::Vector3f::Zero();
    const Eigen::Vector3f p = (frame.camera.ray(x, y) * double{d}).cast<float>();
    return p.z() < farthest_m ? p : Eigen::Vector3f::Zero();
  });
}

TablePoints table_points(const RgbdFrame& frame, double farthest_m) {
  const std::string where = "frame " + std::to_string(frame.sequence);
  frame.camera.check(where);
  if (frame.axial_depth_m.type() != CV_32FC1 ||
      frame.axial_depth_m.size() != cv::Size(frame.camera.width, frame.camera.height)) {
    throw InputError(where, "the depth image does not match the calibration",
                     "register depth to colour and give the calibration of that size");
  }
  return sample(frame.camera.width, frame.camera.height, [&](int x, int y) -> Eigen::Vector3f {
    const float z = frame.axial_depth_m.at<float>(y, x);
    if (!(z > 0 && z < farthest_m)) return Eigen::Vector3f::Zero();
    const Eigen::Vector2f t = frame.camera.undistorted_tangent(x, y).cast<float>();
    return {t.x() * z, t.y() * z, z};
  });
}

}  // namespace sextant
