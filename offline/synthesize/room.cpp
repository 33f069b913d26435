// SPDX-License-Identifier: Apache-2.0
#include "offline/synthesize/room.h"

#include <cmath>
#include <numbers>

#include "offline/synthesize/shapes.h"
#include "offline/synthesize/textures.h"

namespace sextant {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kTableThicknessM = 0.04;
constexpr double kTableHeightM = 0.73;  ///< above the floor
constexpr double kPaperHeightM = 0.0003;

/// A texture in another tint and brightness.
Mesh tinted(Mesh mesh, cv::Mat texture, Random& random) {
  mesh = with_texture(std::move(mesh), std::move(texture));
  const double light = random.uniform(0.75, 1.05);
  for (MeshPart& part : mesh.parts) {
    for (int c = 0; c < 3; ++c) part.diffuse[c] = static_cast<float>(light * random.uniform(0.92, 1.0));
  }
  return mesh;
}

void add_papers(TableScene& scene, TextureLibrary& textures, Random& random) {
  if (!random.chance(0.45)) return;
  for (int i = random.integer(1, 4); i > 0; --i) {
    const bool page = random.chance(0.6);
    const Eigen::Vector2d size = page ? Eigen::Vector2d(0.21, 0.297)
                                      : Eigen::Vector2d(random.uniform(0.08, 0.4), random.uniform(0.08, 0.3));
    const Disc disc{{random.uniform(-0.6, 0.6), random.uniform(0.25, 1.4)}, size.norm() / 2};
    const double yaw = random.uniform(-std::numbers::pi, std::numbers::pi);
    cv::Mat print = textures.pick(page ? TextureKind::kPage : TextureKind::kPrint, random);
    if (!scene.top.holds(disc)) continue;
    scene.surroundings.push_back({tinted(rectangle_shape(size.x(), size.y()), std::move(print), random),
                                  standing_at(disc.centre, kPaperHeightM * i, yaw)});
  }
}

void add_furniture(TableScene& scene, double wall_y, TextureLibrary& textures, Random& random) {
  const double back = scene.top.centre.y() + scene.top.size.y() / 2 + 0.15;
  for (int i = random.integer(0, 5); i > 0; --i) {
    const Eigen::Vector3d size{random.uniform(0.15, 0.9), random.uniform(0.1, 0.4), random.uniform(0.3, 1.7)};
    const Eigen::Vector2d place{random.uniform(-1.8, 1.8),
                                random.uniform(back + 0.3, std::max(back + 0.4, wall_y - 0.3))};
    Mesh mesh = box_shape(size.x(), size.y(), size.z());
    if (random.chance(0.4)) {
      mesh = tinted(std::move(mesh), textures.pick(TextureKind::kPrint, random), random);
    } else {
      mesh = with_colour(std::move(mesh), random_colour({0, 1}, {0, 0.5}, {0.06, 0.9}, random).cast<float>());
    }
    const double yaw = random.uniform(-0.4, 0.4);
    scene.surroundings.push_back({std::move(mesh), standing_at(place, -kTableHeightM, yaw)});
  }
}

}  // namespace

void add_room(TableScene& scene, TextureLibrary& textures, Random& random) {
  const TableTop& top = scene.top;
  scene.surroundings.push_back({tinted(box_shape(top.size.x(), top.size.y(), kTableThicknessM),
                                       textures.pick(TextureKind::kTable, random), random),
                                standing_at(top.centre, -kTableThicknessM, top.yaw_rad)});
  if (random.chance(0.35)) scene.surroundings.back().gloss = random.uniform(0.05, 0.35);
  scene.surroundings.push_back(
      {tinted(rectangle_shape(7, 7), textures.pick(TextureKind::kFloor, random), random),
       standing_at({0, 2}, -kTableHeightM, 0)});
  const double yaw = random.uniform(-0.3, 0.3);
  const double wall_y = top.centre.y() + top.size.y() / 2 + random.uniform(0.2, 1.8);
  // Upright rectangles: the wall behind the table and those beside it.
  const RigidTransform upright(Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitX()));
  const Mesh wall = tinted(rectangle_shape(9, 4), textures.pick(TextureKind::kWall, random), random);
  const double z = 2 - kTableHeightM;
  const RigidTransform back = standing_at({0, wall_y}, z, yaw) * upright;
  scene.surroundings.push_back({wall, back});
  scene.surroundings.push_back({wall, standing_at({-3.2, 1}, z, yaw + std::numbers::pi / 2) * upright});
  scene.surroundings.push_back({wall, standing_at({3.2, 1}, z, yaw - std::numbers::pi / 2) * upright});
  for (int i = random.integer(0, 4); i > 0; --i) {
    const double x = random.uniform(-1.6, 1.6);
    const double y = random.uniform(-1.6, -0.2);
    const double width = random.uniform(0.15, 0.7);
    const double height = random.uniform(0.15, 0.6);
    scene.surroundings.push_back(
        {tinted(rectangle_shape(width, height), textures.pick(TextureKind::kPrint, random), random),
         back * Eigen::Translation3d(x, y, 0.01)});
  }
  add_furniture(scene, wall_y, textures, random);
  add_papers(scene, textures, random);
}

void add_lamps(TableScene& scene, const Eigen::Vector3d& focus, Random& random) {
  const auto lamp = [&](double nearest, double farthest) {
    const double azimuth = random.uniform(-std::numbers::pi, std::numbers::pi);
    const double elevation = random.uniform(30, 85) * kDegree;
    const Eigen::Vector3d direction(std::cos(azimuth) * std::cos(elevation),
                                    std::sin(azimuth) * std::cos(elevation), std::sin(elevation));
    return Eigen::Vector3d(focus + random.uniform(nearest, farthest) * direction);
  };
  scene.light_in_world = lamp(1.2, 2.5);
  scene.ambient = random.uniform(0.35, 0.75);
  for (int i = random.integer(0, 2); i > 0; --i) {
    SceneLight fill;
    fill.p_in_world = lamp(1.0, 3.0);
    fill.strength = random.uniform(0.1, 0.35);
    scene.fills.push_back(fill);
  }
}

}  // namespace sextant
