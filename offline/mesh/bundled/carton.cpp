// SPDX-License-Identifier: Apache-2.0
#include "offline/mesh/bundled/carton.h"

#include <Eigen/Geometry>

namespace sextant {

CartonPanel carton_panel(const CartonSize& size, CartonSide side) {
  const auto [w, d, h] = size;
  switch (side) {
    case CartonSide::kFront:
      return {0, 0, w, h};
    case CartonSide::kRight:
      return {w, 0, d, h};
    case CartonSide::kBack:
      return {w + d, 0, w, h};
    case CartonSide::kLeft:
      return {2 * w + d, 0, d, h};
    case CartonSide::kTop:
      return {0, h, w, d};
    case CartonSide::kBottom:
      break;
  }
  return {w, h, w, d};
}

Mesh carton(const CartonSize& size, const Canvas& sheet) {
  Mesh mesh;
  mesh.textures.push_back(sheet.image());
  MeshPart part;
  part.texture = 0;
  // Upper left, upper right, lower right, lower left corner as seen from outside with the print upright.
  const auto side = [&](CartonSide which, const Eigen::Vector3f& upper_left, const Eigen::Vector3f& right,
                        const Eigen::Vector3f& down) {
    const CartonPanel panel = carton_panel(size, which);
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    constexpr double kInset = 0.2;  // keeps the neighbouring panel's colour out of the interpolation
    for (int k = 0; k < 4; ++k) {
      const int across = k == 1 || k == 2 ? 1 : 0;
      const int below = k >= 2 ? 1 : 0;
      mesh.vertices.emplace_back(upper_left + static_cast<float>(across) * right +
                                 static_cast<float>(below) * down);
      const Eigen::Vector3f out = down.cross(right).normalized();
      mesh.normals.push_back(out);
      mesh.colours.emplace_back(1, 1, 1);
      const double u = panel.x + (across == 0 ? kInset : panel.width - kInset);
      const double v = panel.y + (below == 0 ? kInset : panel.height - kInset);
      mesh.uvs.emplace_back(static_cast<float>(u / size.sheet_width()),
                            static_cast<float>(1 - v / size.sheet_height()));
    }
    part.triangles.push_back({first, first + 3, first + 2});
    part.triangles.push_back({first, first + 2, first + 1});
  };
  const auto w = static_cast<float>(size.width / 2);
  const auto d = static_cast<float>(size.depth / 2);
  const auto h = static_cast<float>(size.height);
  side(CartonSide::kFront, {-w, -d, h}, {2 * w, 0, 0}, {0, 0, -h});
  side(CartonSide::kRight, {w, -d, h}, {0, 2 * d, 0}, {0, 0, -h});
  side(CartonSide::kBack, {w, d, h}, {-2 * w, 0, 0}, {0, 0, -h});
  side(CartonSide::kLeft, {-w, d, h}, {0, -2 * d, 0}, {0, 0, -h});
  side(CartonSide::kTop, {-w, d, h}, {2 * w, 0, 0}, {0, -2 * d, 0});
  side(CartonSide::kBottom, {-w, -d, 0}, {2 * w, 0, 0}, {0, 2 * d, 0});
  mesh.parts.push_back(part);
  return mesh;
}

}  // namespace sextant
