// SPDX-License-Identifier: Apache-2.0
#include "runtime/refine/depth_raster.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace sextant {
namespace {

constexpr float kNearest = 0.05F;  // metres

}  // namespace

void DepthRaster::draw(const ModelMesh& mesh, const RigidTransform& camera_from_object,
                       const PinholeCamera& camera) {
  const Eigen::Matrix3f rotation = camera_from_object.linear().cast<float>();
  const Eigen::Vector3f translation = camera_from_object.translation().cast<float>();
  const auto focal = static_cast<float>(camera.focal);
  const auto cx = static_cast<float>(camera.cx);
  const auto cy = static_cast<float>(camera.cy);
  vertices_.resize(mesh.vertices.size());
  projected_.resize(mesh.vertices.size());
  float x0 = std::numeric_limits<float>::max();
  float y0 = x0;
  float x1 = -x0;
  float y1 = -x0;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Eigen::Vector3f p = rotation * mesh.vertices[i] + translation;
    vertices_[i] = p;
    if (!(p.z() > kNearest)) {
      projected_[i] = {0, 0, 0};
      continue;
    }
    const float inverse = 1 / p.z();
    projected_[i] = {cx + focal * p.x() * inverse, cy + focal * p.y() * inverse, inverse};
    x0 = std::min(x0, projected_[i].x());
    x1 = std::max(x1, projected_[i].x());
    y0 = std::min(y0, projected_[i].y());
    y1 = std::max(y1, projected_[i].y());
  }
  const auto limited = [](float v, int size) {
    return static_cast<int>(std::clamp(v, -1.0F, static_cast<float>(size)));
  };
  const int left = std::max(0, limited(std::floor(x0), camera.width));
  const int top = std::max(0, limited(std::floor(y0), camera.height));
  const int right = std::min(camera.width, limited(std::ceil(x1), camera.width) + 1);
  const int bottom = std::min(camera.height, limited(std::ceil(y1), camera.height) + 1);
  window_ = x0 > x1 || right <= left || bottom <= top ? cv::Rect()
                                                      : cv::Rect(left, top, right - left, bottom - top);
  const std::size_t pixels =
      static_cast<std::size_t>(window_.width) * static_cast<std::size_t>(window_.height);
  inverse_depth_.assign(pixels, 0.0F);
  triangle_.assign(pixels, kBackground);
  if (pixels == 0) return;
  for (Eigen::Vector3f& p : projected_) {
    p.x() -= static_cast<float>(left);
    p.y() -= static_cast<float>(top);
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    draw_triangle(static_cast<std::int32_t>(t), mesh.triangles[t]);
  }
}

void DepthRaster::draw_triangle(std::int32_t number, const std::array<std::uint32_t, 3>& corners) {
  const Eigen::Vector3f& a = projected_[corners[0]];
  Eigen::Vector3f b = projected_[corners[1]];
  Eigen::Vector3f c = projected_[corners[2]];
  if (a.z() <= 0 || b.z() <= 0 || c.z() <= 0) return;
  float area = (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
  if (area < 0) {
    std::swap(b, c);
    area = -area;
  }
  if (!(area > 1e-9F)) return;
  const int rows = window_.height;
  const int columns = window_.width;
  const float low = std::max(0.0F, std::ceil(std::min({a.y(), b.y(), c.y()})));
  const float high = std::min(static_cast<float>(rows - 1), std::floor(std::max({a.y(), b.y(), c.y()})));
  // Each side bounds the rows it spans on the left or on the right: x(y) = at + slope (y - from.y).
  struct Side {
    float at = 0, slope = 0, from_y = 0;
    bool left = false;
  };
  std::array<Side, 3> sides;
  std::size_t count = 0;
  const auto add_side = [&](const Eigen::Vector3f& p, const Eigen::Vector3f& q) {
    const float rise = q.y() - p.y();
    if (rise == 0) return;  // level sides bound no row
    sides[count++] = {p.x(), (q.x() - p.x()) / rise, p.y(), rise < 0};
  };
  add_side(a, b);
  add_side(b, c);
  add_side(c, a);
  // 1 / Z = zx (x - ax) + zy (y - ay) + az.
  const float zx = ((b.z() - a.z()) * (c.y() - a.y()) - (c.z() - a.z()) * (b.y() - a.y())) / area;
  const float zy = ((c.z() - a.z()) * (b.x() - a.x()) - (b.z() - a.z()) * (c.x() - a.x())) / area;
  // A triangle seen edge-on has huge slopes: what it shows stays between its corners.
  const float farthest = std::min({a.z(), b.z(), c.z()});
  const float nearest = std::max({a.z(), b.z(), c.z()});
  // Rounding must not open cracks between neighbours: pixels within this of an edge belong to both.
  constexpr float kSlack = 1e-3F;
  for (float y = low; y <= high; y += 1) {
    float lo = 0;
    auto hi = static_cast<float>(columns - 1);
    for (std::size_t k = 0; k < count; ++k) {
      const float x = sides[k].at + sides[k].slope * (y - sides[k].from_y);
      if (sides[k].left) {
        lo = std::max(lo, x);
      } else {
        hi = std::min(hi, x);
      }
    }
    if (hi < lo - 2 * kSlack || hi + kSlack < 0) continue;
    // Rounded up and down: lo is not negative.
    const auto first = static_cast<int>(lo + (1 - kSlack));
    const auto last = static_cast<int>(std::min(static_cast<float>(columns - 1), hi + kSlack));
    const std::size_t row = static_cast<std::size_t>(y) * static_cast<std::size_t>(columns);
    const float z_row = a.z() + zy * (y - a.y()) - zx * a.x();
    for (int x = first; x <= last; ++x) {
      const float z = std::clamp(z_row + zx * static_cast<float>(x), farthest, nearest);
      const std::size_t at = row + static_cast<std::size_t>(x);
      if (z > inverse_depth_[at]) {
        inverse_depth_[at] = z;
        triangle_[at] = number;
      }
    }
  }
}

}  // namespace sextant
