// SPDX-License-Identifier: Apache-2.0
#include "offline/learn/scenery.h"

#include "offline/synthesize/shapes.h"
#include "offline/synthesize/textures.h"

namespace sextant {
namespace {

constexpr int kPlainTables = 12;
constexpr int kTexturedTables = 10;
constexpr int kThings = 20;
constexpr double kTableSide = 6;  ///< metres: reaches behind the object at any elevation that is learnt
const cv::Size kTableTexture(512, 512);
const cv::Size kThingTexture(128, 128);

Mesh table_of(double side_m, cv::Mat texture) {
  return with_texture(rectangle_shape(side_m, side_m), std::move(texture));
}

SceneryThing random_thing(Renderer& renderer, Random& random) {
  const auto finish = [&](Mesh mesh) {
    return renderer.upload(
        random.chance(0.6)
            ? with_texture(std::move(mesh), print_texture(kThingTexture, random))
            : with_colour(std::move(mesh),
                          random_colour({0, 1}, {0.05, 0.95}, {0.15, 0.98}, random).cast<float>()));
  };
  if (random.chance(0.5)) {
    const double x = random.uniform(0.03, 0.18);
    const double y = random.uniform(0.03, 0.1);
    const double z = random.uniform(0.04, 0.25);
    return {finish(box_shape(x, y, z)), Eigen::Vector2d(x, y).norm() / 2};
  }
  const double radius = random.uniform(0.02, 0.06);
  const double height = random.uniform(0.04, 0.24);
  return {finish(cylinder_shape(radius, height)), radius};
}

}  // namespace

Scenery::Scenery(Renderer& renderer) {
  Random random(20150612);
  for (int i = 0; i < kPlainTables; ++i) {
    const Eigen::Vector3d colour = random_colour({0, 1}, {0, 0.15}, {0.05, 1}, random);
    plain_tables.push_back(
        renderer.upload(with_colour(rectangle_shape(kTableSide, kTableSide), colour.cast<float>())));
  }
  // The texture is repeated by no one: a smaller top keeps its grain at a natural size.
  for (int i = 0; i < kTexturedTables; ++i) {
    textured_tables.push_back(renderer.upload(table_of(2.4, table_texture(kTableTexture, random))));
  }
  for (int i = 0; i < kThings; ++i) things.push_back(random_thing(renderer, random));
}

}  // namespace sextant
