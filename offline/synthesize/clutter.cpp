// SPDX-License-Identifier: Apache-2.0
#include "offline/synthesize/clutter.h"

#include <algorithm>
#include <cmath>

#include "offline/synthesize/shapes.h"
#include "offline/synthesize/textures.h"

namespace sextant {
namespace {

/// Printed or of one colour.
Mesh dressed(Mesh mesh, const ClutterStock& stock, Random& random) {
  if (random.chance(0.6))
    return with_texture(std::move(mesh), stock.textures.pick(TextureKind::kPrint, random));
  return with_colour(std::move(mesh),
                     random_colour({0, 1}, {0.05, 0.95}, {0.15, 0.98}, random).cast<float>());
}

/// A package as large as a target, with another print: what a look-alike is.
ClutterThing decoy_of(const Footprint& target, const ClutterStock& stock, Random& random) {
  Eigen::Vector3d size = target.size_m;
  for (int i = 0; i < 3; ++i) size[i] *= random.uniform(0.94, 1.06);
  ClutterThing thing;
  const bool round = std::abs(size.x() - size.y()) < 0.15 * size.x();
  thing.radius_m = round ? size.x() / 2 : size.head<2>().norm() / 2;
  thing.mesh =
      dressed(round ? cylinder_shape(size.x() / 2, size.z()) : box_shape(size.x(), size.y(), size.z()), stock,
              random);
  return thing;
}

ClutterThing named(const ClutterStock& stock, Random& random) {
  ClutterThing thing;
  thing.distractor = random.integer(0, static_cast<int>(stock.distractors.size()) - 1);
  const Footprint& footprint = stock.distractors[static_cast<std::size_t>(thing.distractor)];
  thing.radius_m = footprint.horizontal_radius_m;
  thing.lift_m = footprint.centre_height_m;
  return thing;
}

ClutterThing plain_shape(const ClutterStock& stock, Random& random) {
  ClutterThing thing;
  switch (random.integer(0, 6)) {
    case 0:
    case 1: {
      const Eigen::Vector3d size{random.uniform(0.03, 0.18), random.uniform(0.03, 0.1),
                                 random.uniform(0.03, 0.25)};
      thing.mesh = dressed(box_shape(size.x(), size.y(), size.z()), stock, random);
      thing.radius_m = size.head<2>().norm() / 2;
      return thing;
    }
    case 2:
    case 3:
      thing.radius_m = random.uniform(0.02, 0.06);
      thing.mesh = dressed(cylinder_shape(thing.radius_m, random.uniform(0.04, 0.24)), stock, random);
      return thing;
    case 4:
      thing.radius_m = random.uniform(0.025, 0.06);
      thing.mesh = dressed(sphere_shape(thing.radius_m), stock, random);
      return thing;
    case 5: {
      // A bowl, open above.
      const double r = random.uniform(0.05, 0.09);
      const double h = random.uniform(0.5, 0.9) * r;
      thing.radius_m = r;
      thing.mesh = dressed(lathe_shape({{0, 0},
                                        {0.5 * r, 0},
                                        {0.8 * r, 0.35 * h},
                                        {r, h},
                                        {0.95 * r, h},
                                        {0.75 * r, 0.4 * h},
                                        {0.45 * r, 0.1 * h},
                                        {0, 0.1 * h}}),
                           stock, random);
      return thing;
    }
    default:
      thing.radius_m = random.uniform(0.025, 0.045);
      thing.mesh = dressed(bottle_shape(thing.radius_m, random.uniform(0.15, 0.28)), stock, random);
      return thing;
  }
}

}  // namespace

bool free_of(const Disc& disc, const std::vector<Disc>& others) {
  return std::none_of(others.begin(), others.end(), [&](const Disc& o) {
    return (disc.centre - o.centre).norm() < disc.radius + o.radius + kClutterGapM;
  });
}

bool TableTop::holds(const Disc& disc) const {
  const Eigen::Vector2d p = Eigen::Rotation2Dd(-yaw_rad) * (disc.centre - centre);
  return std::abs(p.x()) + disc.radius < size.x() / 2 && std::abs(p.y()) + disc.radius < size.y() / 2;
}

RigidTransform standing_at(const Eigen::Vector2d& place, double z, double yaw_rad) {
  return Eigen::Translation3d(place.x(), place.y(), z) * Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ());
}

ClutterThing random_clutter(const ClutterStock& stock, Random& random) {
  const double what = random.uniform();
  const double gloss = random.chance(0.3) ? random.uniform(0.1, 0.8) : 0;
  ClutterThing thing;
  if (!stock.distractors.empty() && what < stock.distractor_share) {
    thing = named(stock, random);
  } else if (!stock.targets.empty() && what > 1 - stock.decoy_share) {
    const int which = random.integer(0, static_cast<int>(stock.targets.size()) - 1);
    thing = decoy_of(stock.targets[static_cast<std::size_t>(which)], stock, random);
  } else {
    thing = plain_shape(stock, random);
  }
  thing.gloss = gloss;
  return thing;
}

ClutterThing random_occluder(const ClutterStock& stock, double radius_m, double height_m, Random& random) {
  ClutterThing thing;
  thing.radius_m = radius_m;
  if (random.chance(0.5)) {
    thing.mesh = dressed(cylinder_shape(radius_m, height_m), stock, random);
  } else {
    const double half_depth = radius_m * random.uniform(0.3, 0.7);
    const double half_width = std::sqrt(radius_m * radius_m - half_depth * half_depth);
    thing.mesh = dressed(box_shape(2 * half_width, 2 * half_depth, height_m), stock, random);
  }
  return thing;
}

}  // namespace sextant
