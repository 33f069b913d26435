// SPDX-License-Identifier: Apache-2.0
#include "offline/synthesize/scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "offline/synthesize/room.h"
#include "runtime/base/error.h"

namespace sextant {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

double full_turn(Random& random) { return random.uniform(-std::numbers::pi, std::numbers::pi); }

/// A pixel for a target's centre. `reach`: of its projected sphere, pixels.
Eigen::Vector2d border_pixel(const PinholeCamera& camera, double reach, Random& random) {
  const double inside = reach * random.uniform(0.05, 0.9);
  const bool upright_border = random.chance(0.6);
  const double along = random.uniform(0.15, 0.85);
  if (upright_border) {
    const bool left = random.chance(0.5);
    return {left ? inside : camera.width - 1 - inside, along * camera.height};
  }
  return {along * camera.width, camera.height - 1 - inside};
}

/// Where the centre of a target may be, seen at a random pixel; nothing where that does not fit.
std::optional<Eigen::Vector3d> place_target(const SceneOptions& options,
                                            const RigidTransform& world_from_camera, const Footprint& target,
                                            bool cut, Random& random) {
  const PinholeCamera& camera = options.camera;
  Eigen::Vector2d pixel;
  if (cut) {
    const double guess = camera.focal * target.bounding_radius_m / random.in(options.distance_m);
    pixel = border_pixel(camera, guess, random);
  } else {
    pixel.x() = random.uniform(0, camera.width - 1);
    pixel.y() = random.uniform(0, camera.height - 1);
  }
  const Eigen::Vector3d ray_in_camera = camera.ray(pixel.x(), pixel.y());
  const Eigen::Vector3d ray = world_from_camera.linear() * ray_in_camera;
  const Eigen::Vector3d eye = world_from_camera.translation();
  if (ray.z() > -0.02) return std::nullopt;
  const double distance = (target.centre_height_m - eye.z()) / ray.z();
  if (!(distance >= options.distance_m.lo && distance <= options.distance_m.hi)) return std::nullopt;
  // The projected sphere, a little generous.
  const double axial = distance * ray_in_camera.z();
  if (axial <= 1.5 * target.bounding_radius_m) return std::nullopt;
  const double reach = 1.15 * camera.focal * target.bounding_radius_m / axial;
  const double margin = std::min(std::min(pixel.x(), camera.width - 1 - pixel.x()),
                                 std::min(pixel.y(), camera.height - 1 - pixel.y()));
  if (cut ? margin > reach / 1.15 : margin < reach) return std::nullopt;
  return Eigen::Vector3d(eye + distance * ray);
}

bool place_targets(const SceneOptions& options, const std::vector<Footprint>& targets, TableScene& scene,
                   Random& random) {
  constexpr int kDraws = 40;
  const RigidTransform world_from_camera = scene.camera_from_world.inverse();
  for (const Footprint& target : targets) {
    const bool cut = options.cut_share > 0 && random.chance(options.cut_share);
    bool placed = false;
    for (int draw = 0; draw < kDraws && !placed; ++draw) {
      const auto centre = place_target(options, world_from_camera, target, cut, random);
      if (!centre) continue;
      const Disc disc{centre->head<2>(), target.horizontal_radius_m};
      if (!scene.top.holds(disc) || !free_of(disc, scene.taken)) continue;
      scene.taken.push_back(disc);
      scene.cut.push_back(cut);
      scene.world_from_target.push_back(standing_at(disc.centre, target.centre_height_m, full_turn(random)));
      placed = true;
    }
    if (!placed) return false;
  }
  return true;
}

void put(TableScene& scene, ClutterThing thing, const Disc& disc, double yaw_rad) {
  PlacedMesh placed;
  placed.mesh = std::move(thing.mesh);
  placed.distractor = thing.distractor;
  placed.gloss = thing.gloss;
  placed.world_from_mesh = standing_at(disc.centre, thing.lift_m, yaw_rad);
  scene.surroundings.push_back(std::move(placed));
  scene.taken.push_back(disc);
}

void add_clutter(const SceneOptions& options, const ClutterStock& stock, TableScene& scene, Random& random) {
  const std::vector<Disc> targets = scene.taken;
  const int count =
      random.integer(static_cast<int>(options.clutter.lo), static_cast<int>(options.clutter.hi));
  for (int i = 0; i < count; ++i) {
    ClutterThing thing = random_clutter(stock, random);
    for (int attempt = 0; attempt < 60; ++attempt) {
      // Two of three beside a target, the others anywhere on the table.
      Disc disc{{0, 0}, thing.radius_m};
      if (i % 3 < 2 && !targets.empty()) {
        const int beside = random.integer(0, static_cast<int>(targets.size()) - 1);
        const Disc& near = targets[static_cast<std::size_t>(beside)];
        const double angle = full_turn(random);
        const double away =
            near.radius + thing.radius_m + kClutterGapM + 0.35 * std::pow(random.uniform(), 2);
        disc.centre = near.centre + away * Eigen::Vector2d(std::cos(angle), std::sin(angle));
      } else {
        disc.centre.x() = random.uniform(-0.7, 0.7);
        disc.centre.y() = random.uniform(0.3, 1.6);
      }
      // Nothing in front of the lens.
      if (!scene.top.holds(disc) || !free_of(disc, scene.taken) || disc.centre.norm() < 0.25) continue;
      put(scene, std::move(thing), disc, full_turn(random));
      break;
    }
  }
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

TableScene compose_scene(const SceneOptions& options, const std::vector<Footprint>& targets,
                         const ClutterStock& stock, Random& random) {
  constexpr int kAttempts = 1500;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    TableScene scene;
    const double pitch = random.in(options.pitch_deg) * kDegree;
    const double roll = random.in(options.roll_deg) * kDegree;
    const double height = random.in(options.height_m);
    scene.table = TableGeometry::from_pitch_roll(pitch, roll, height);
    scene.camera_from_world = camera_from_world(pitch, roll, height);
    TableTop& top = scene.top;
    top.size.x() = random.uniform(1.0, 2.4);
    top.size.y() = random.uniform(0.9, 1.8);
    top.yaw_rad = random.uniform(-0.35, 0.35);
    top.centre.x() = random.uniform(-0.25, 0.25);
    top.centre.y() = top.size.y() / 2 + random.uniform(-0.1, 0.25);
    if (!place_targets(options, targets, scene, random)) continue;

    add_room(scene, stock.textures, random);
    scene.first_clutter = scene.surroundings.size();
    add_clutter(options, stock, scene, random);
    const Eigen::Vector3d focus = targets.empty() ? Eigen::Vector3d(0, 0.7, 0)
                                                  : Eigen::Vector3d(scene.world_from_target[0].translation());
    add_lamps(scene, focus, random);
    return scene;
  }
  throw UsageError("no place was found where the objects stand as wanted",
                   "widen the ranges of pitch, height and distance, or put fewer objects into one image");
}

bool add_occluder(TableScene& scene, std::size_t target, const Footprint& footprint, double hidden,
                  const ClutterStock& stock, Random& random) {
  const RigidTransform& object = scene.world_from_target[target];
  const Eigen::Vector2d place = object.translation().head<2>();
  const Eigen::Vector2d to_camera = -place.normalized();
  const Eigen::Vector2d aside(-to_camera.y(), to_camera.x());
  // Half of the width that the camera sees of the object's box.
  double half_width = 0;
  for (int axis = 0; axis < 2; ++axis)
    half_width += 0.5 * footprint.size_m[axis] * std::abs(object.linear().col(axis).head<2>().dot(aside));
  const double camera_height = scene.table.camera_height_m;
  const double slope = (camera_height - footprint.centre_height_m) / place.norm();
  for (int attempt = 0; attempt < 30; ++attempt) {
    const bool column = random.chance(0.65);
    const double radius =
        std::max(0.018, half_width * (column ? random.uniform(0.4, 1.0) : random.uniform(0.9, 1.3)));
    const double forward =
        footprint.horizontal_radius_m + radius + kClutterGapM + random.uniform(0.001, 0.06);
    // A line of sight to height z of the object passes the thing at z + forward * slope.
    const double covered = column ? random.uniform(0.9, 1.4) : hidden * random.uniform(0.8, 1.3);
    const double height = forward * slope + covered * footprint.size_m.z();
    const double overlap = column ? 2 * half_width * hidden * random.uniform(0.8, 1.3) : half_width + radius;
    const double side = random.chance(0.5) ? 1 : -1;
    const double sideways = side * std::max(0.0, half_width + radius - overlap);
    const Disc disc{place + forward * to_camera + sideways * aside, radius};
    if (height > 0.8 * camera_height || disc.centre.norm() < 0.2 || !scene.top.holds(disc) ||
        !free_of(disc, scene.taken)) {
      continue;
    }
    put(scene, random_occluder(stock, radius, height, random), disc, full_turn(random));
    return true;
  }
  return false;
}

void remove_clutter(TableScene& scene, std::size_t index) {
  const auto at = static_cast<std::ptrdiff_t>(index);
  const auto disc = static_cast<std::ptrdiff_t>(scene.world_from_target.size() + index - scene.first_clutter);
  scene.surroundings.erase(scene.surroundings.begin() + at);
  scene.taken.erase(scene.taken.begin() + disc);
}

}  // namespace sextant
