// SPDX-License-Identifier: Apache-2.0
#include "offline/synthesize/scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "offline/synthesize/shapes.h"
#include "offline/synthesize/textures.h"
#include "runtime/base/error.h"

namespace sextant {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kGapM = 0.008;  ///< air between neighbours
constexpr double kTableThicknessM = 0.04;
constexpr double kTableHeightM = 0.73;  ///< above the floor
const cv::Size kLargeTexture(768, 768);
const cv::Size kSmallTexture(256, 256);

/// A disc on the table.
struct Disc {
  Eigen::Vector2d centre{0, 0};
  double radius = 0;
};

bool free_of(const Disc& disc, const std::vector<Disc>& others) {
  return std::none_of(others.begin(), others.end(), [&](const Disc& o) {
    return (disc.centre - o.centre).norm() < disc.radius + o.radius + kGapM;
  });
}

/// The table's top: a rectangle, turned about the vertical.
struct TableTop {
  Eigen::Vector2d centre{0, 0};
  Eigen::Vector2d size{1, 1};
  double yaw_rad = 0;

  bool holds(const Disc& disc) const {
    const Eigen::Vector2d p = Eigen::Rotation2Dd(-yaw_rad) * (disc.centre - centre);
    return std::abs(p.x()) + disc.radius < size.x() / 2 && std::abs(p.y()) + disc.radius < size.y() / 2;
  }
};

RigidTransform standing_at(const Eigen::Vector2d& place, double z, double yaw_rad) {
  return Eigen::Translation3d(place.x(), place.y(), z) * Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ());
}

/// Where the centre of a target may be, seen at a random pixel; nothing where that does not fit.
std::optional<Eigen::Vector3d> place_target(const SceneOptions& options,
                                            const RigidTransform& world_from_camera, const Footprint& target,
                                            Random& random) {
  const PinholeCamera& camera = options.camera;
  const double x = random.uniform(0, camera.width - 1);
  const double y = random.uniform(0, camera.height - 1);
  const Eigen::Vector3d ray_in_camera = camera.ray(x, y);
  const Eigen::Vector3d ray = world_from_camera.linear() * ray_in_camera;
  const Eigen::Vector3d eye = world_from_camera.translation();
  if (ray.z() > -0.02) return std::nullopt;
  const double distance = (target.centre_height_m - eye.z()) / ray.z();
  if (!(distance >= options.distance_m.lo && distance <= options.distance_m.hi)) return std::nullopt;
  // The projected sphere, a little generous.
  const double axial = distance * ray_in_camera.z();
  if (axial <= 1.5 * target.bounding_radius_m) return std::nullopt;
  const double reach = 1.15 * camera.focal * target.bounding_radius_m / axial;
  if (x < reach || y < reach || x > camera.width - 1 - reach || y > camera.height - 1 - reach)
    return std::nullopt;
  return Eigen::Vector3d(eye + distance * ray);
}

/// A random thing of about a hand's size, and the radius of its footprint.
std::pair<Mesh, double> random_clutter(Random& random) {
  const Eigen::Vector3f colour = random_colour({0, 1}, {0.05, 0.95}, {0.15, 0.98}, random).cast<float>();
  const auto finish = [&](Mesh mesh) {
    return random.chance(0.55) ? with_texture(std::move(mesh), print_texture(kSmallTexture, random))
                               : with_colour(std::move(mesh), colour);
  };
  switch (random.integer(0, 5)) {
    case 0:
    case 1: {
      const Eigen::Vector3d size{random.uniform(0.03, 0.18), random.uniform(0.03, 0.1),
                                 random.uniform(0.04, 0.25)};
      return {finish(box_shape(size.x(), size.y(), size.z())), size.head<2>().norm() / 2};
    }
    case 2:
    case 3: {
      const double radius = random.uniform(0.02, 0.06);
      return {finish(cylinder_shape(radius, random.uniform(0.04, 0.24))), radius};
    }
    case 4: {
      const double radius = random.uniform(0.025, 0.06);
      return {finish(sphere_shape(radius)), radius};
    }
    default: {
      const double radius = random.uniform(0.025, 0.045);
      return {finish(bottle_shape(radius, random.uniform(0.15, 0.28))), radius};
    }
  }
}

void add_clutter(const SceneOptions& options, const TableTop& top, std::vector<Disc>& taken,
                 TableScene& scene, Random& random) {
  const std::vector<Disc> targets = taken;
  const int count =
      random.integer(static_cast<int>(options.clutter.lo), static_cast<int>(options.clutter.hi));
  for (int i = 0; i < count; ++i) {
    auto [mesh, radius] = random_clutter(random);
    for (int attempt = 0; attempt < 60; ++attempt) {
      // Two of three beside a target, the others anywhere on the table.
      Disc disc{{0, 0}, radius};
      if (i % 3 < 2) {
        const int beside = random.integer(0, static_cast<int>(targets.size()) - 1);
        const Disc& near = targets[static_cast<std::size_t>(beside)];
        const double angle = random.uniform(-std::numbers::pi, std::numbers::pi);
        const double away = near.radius + radius + kGapM + 0.35 * std::pow(random.uniform(), 2);
        disc.centre = near.centre + away * Eigen::Vector2d(std::cos(angle), std::sin(angle));
      } else {
        disc.centre = {random.uniform(-0.7, 0.7), random.uniform(0.3, 1.6)};
      }
      // Nothing in front of the lens.
      if (!top.holds(disc) || !free_of(disc, taken) || disc.centre.norm() < 0.25) continue;
      taken.push_back(disc);
      scene.surroundings.push_back(
          {std::move(mesh),
           standing_at(disc.centre, 0, random.uniform(-std::numbers::pi, std::numbers::pi))});
      break;
    }
  }
}

void add_room(const TableTop& top, TableScene& scene, Random& random) {
  scene.surroundings.push_back({with_texture(box_shape(top.size.x(), top.size.y(), kTableThicknessM),
                                             table_texture(kLargeTexture, random)),
                                standing_at(top.centre, -kTableThicknessM, top.yaw_rad)});
  const auto floor =
      random.chance(0.5) ? wood_texture(kLargeTexture, random) : tile_texture(kLargeTexture, random);
  scene.surroundings.push_back(
      {with_texture(rectangle_shape(7, 7), floor), standing_at({0, 2}, -kTableHeightM, 0)});
  const cv::Mat plaster =
      random.chance(0.75) ? plain_texture(kLargeTexture, random) : tile_texture(kLargeTexture, random);
  const double yaw = random.uniform(-0.3, 0.3);
  const double wall_distance = top.centre.y() + top.size.y() / 2 + random.uniform(0.2, 1.8);
  // Upright rectangles: the wall behind the table and those beside it.
  const RigidTransform upright(Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitX()));
  const Mesh wall = with_texture(rectangle_shape(9, 4), plaster);
  const double z = 2 - kTableHeightM;
  scene.surroundings.push_back({wall, standing_at({0, wall_distance}, z, yaw) * upright});
  scene.surroundings.push_back({wall, standing_at({-3.2, 1}, z, yaw + std::numbers::pi / 2) * upright});
  scene.surroundings.push_back({wall, standing_at({3.2, 1}, z, yaw - std::numbers::pi / 2) * upright});
}

}  // namespace

RigidTransform camera_from_world(double pitch_rad, double roll_rad, double height_m) {
  const Eigen::Vector3d forward(0, std::cos(pitch_rad), -std::sin(pitch_rad));
  const Eigen::Vector3d level_right(1, 0, 0);
  const Eigen::Vector3d level_down(0, -std::sin(pitch_rad), -std::cos(pitch_rad));
  RigidTransform world_from_camera = RigidTransform::Identity();
  world_from_camera.linear().col(0) = std::cos(roll_rad) * level_right + std::sin(roll_rad) * level_down;
  world_from_camera.linear().col(1) = -std::sin(roll_rad) * level_right + std::cos(roll_rad) * level_down;
  world_from_camera.linear().col(2) = forward;
  world_from_camera.translation() = Eigen::Vector3d(0, 0, height_m);
  return world_from_camera.inverse();
}

TableScene compose_scene(const SceneOptions& options, const std::vector<Footprint>& targets, Random& random) {
  constexpr int kAttempts = 4000;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    TableScene scene;
    const double pitch = random.in(options.pitch_deg) * kDegree;
    const double roll = random.in(options.roll_deg) * kDegree;
    const double height = random.in(options.height_m);
    scene.table = TableGeometry::from_pitch_roll(pitch, roll, height);
    scene.camera_from_world = camera_from_world(pitch, roll, height);
    TableTop top;
    top.size = {random.uniform(1.0, 2.4), random.uniform(0.9, 1.8)};
    top.yaw_rad = random.uniform(-0.35, 0.35);
    top.centre = {random.uniform(-0.25, 0.25), top.size.y() / 2 + random.uniform(-0.1, 0.25)};

    std::vector<Disc> taken;
    for (const Footprint& target : targets) {
      const auto centre = place_target(options, scene.camera_from_world.inverse(), target, random);
      if (!centre) break;
      const Disc disc{centre->head<2>(), target.horizontal_radius_m};
      if (!top.holds(disc) || !free_of(disc, taken)) break;
      taken.push_back(disc);
      scene.world_from_target.push_back(standing_at(disc.centre, target.centre_height_m,
                                                    random.uniform(-std::numbers::pi, std::numbers::pi)));
    }
    if (taken.size() < targets.size()) continue;

    add_room(top, scene, random);
    add_clutter(options, top, taken, scene, random);
    const double azimuth = random.uniform(-std::numbers::pi, std::numbers::pi);
    const double elevation = random.uniform(35, 80) * kDegree;
    const Eigen::Vector3d direction(std::cos(azimuth) * std::cos(elevation),
                                    std::sin(azimuth) * std::cos(elevation), std::sin(elevation));
    scene.light_in_world = scene.world_from_target[0].translation() + random.uniform(1.2, 2.5) * direction;
    scene.ambient = random.uniform(0.35, 0.65);
    return scene;
  }
  throw UsageError("no place was found where the objects stand wholly inside the picture",
                   "widen the ranges of pitch, height and distance, or put fewer objects into one image");
}

}  // namespace sextant
