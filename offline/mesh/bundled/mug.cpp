// SPDX-License-Identifier: Apache-2.0
// A plain mug: hollow, with a foot and a handle. No colours: it is found by its shape.
#include <cmath>
#include <numbers>

#include "offline/mesh/bundled/bundled_meshes.h"
#include "offline/mesh/bundled/shapes.h"

namespace sextant {

Mesh mug() {
  constexpr int kSegments = 72;
  const Eigen::Vector3f white(1, 1, 1);
  const auto plain = [&](double, std::size_t, double) { return white; };
  Mesh mesh;
  std::vector<ProfilePoint> profile{{0, 2.5}, {24, 2.5}, {26, 0}, {30, 0}};
  for (const ProfilePoint& p :
       smooth_profile({{32, 0.6}, {36, 4}, {38.6, 12}, {39.6, 30}, {40, 60}, {40, 89.5}}, 3)) {
    profile.push_back(p);
  }
  for (const ProfilePoint& p : {ProfilePoint{39.4, 91.3}, ProfilePoint{38, 92}, ProfilePoint{36.6, 91.3}})
    profile.push_back(p);
  for (const ProfilePoint& p :
       smooth_profile({{36, 89.5}, {36, 60}, {35.6, 30}, {34, 14}, {29, 7.5}, {20, 6}, {0, 5.5}}, 2)) {
    profile.push_back(p);
  }
  add_lathe(mesh, profile, kSegments, plain);
  std::vector<Eigen::Vector3d> path;
  constexpr int kSteps = 32;
  for (int i = 0; i <= kSteps; ++i) {
    const double t = std::numbers::pi * (static_cast<double>(i) / kSteps - 0.5);
    path.emplace_back(38 + 30 * std::pow(std::cos(t), 0.8), 0, 48 - 27 * std::sin(t));
  }
  add_tube(mesh, path, 6.5, 4, {0, 1, 0}, 16, white);
  return mesh;
}

}  // namespace sextant
