// SPDX-License-Identifier: Apache-2.0
#include "offline/mesh/simplify.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include "offline/mesh/bundled/bundled_meshes.h"
#include "tests/unit/offline/mesh/test_files.h"

namespace sextant {
namespace {

// A closed torus with bumps, `n` x `n` quads.
Mesh bumpy_torus(int n) {
  Mesh mesh;
  MeshPart part;
  for (int i = 0; i < n; ++i) {
    for (int k = 0; k < n; ++k) {
      const double a = 2 * std::numbers::pi * i / n;
      const double b = 2 * std::numbers::pi * k / n;
      const double r = 0.03 + 0.003 * std::cos(5 * a) * std::sin(3 * b);
      mesh.vertices.emplace_back(Eigen::Vector3d((0.07 + r * std::cos(b)) * std::cos(a),
                                                 (0.07 + r * std::cos(b)) * std::sin(a), r * std::sin(b))
                                     .cast<float>());
      mesh.normals.emplace_back(0, 0, 1);
      mesh.colours.emplace_back(1, 1, 1);
      mesh.uvs.emplace_back(0, 0);
      const auto at = [n](int u, int v) { return static_cast<std::uint32_t>((u % n) * n + v % n); };
      part.triangles.push_back({at(i, k), at(i + 1, k), at(i + 1, k + 1)});
      part.triangles.push_back({at(i, k), at(i + 1, k + 1), at(i, k + 1)});
    }
  }
  mesh.parts.push_back(part);
  return mesh;
}

void expect_sound(const ModelMesh& mesh, std::size_t most) {
  EXPECT_LE(mesh.triangles.size(), most);
  EXPECT_GT(mesh.triangles.size(), 0U);
  for (const auto& p : mesh.vertices) {
    EXPECT_TRUE(p.allFinite());
  }
  for (const auto& t : mesh.triangles) {
    EXPECT_NE(t[0], t[1]);
    EXPECT_NE(t[1], t[2]);
    EXPECT_NE(t[2], t[0]);
    for (const auto v : t) {
      ASSERT_LT(v, mesh.vertices.size());
    }
  }
}

bool is_closed(const ModelMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const auto& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) ++edges[{t.at(k), t.at((k + 1) % 3)}];
  }
  return std::all_of(edges.begin(), edges.end(), [&](const auto& e) {
    const auto back = edges.find({e.first.second, e.first.first});
    return e.second == 1 && back != edges.end() && back->second == 1;
  });
}

TEST(Simplify, FourThousandTrianglesStayWithinOnePercent) {
  const double torus_radius = 0.103;
  const Mesh torus = bumpy_torus(160);  // 51,200 triangles
  const ModelMesh coarse = simplified(torus, 4000);
  expect_sound(coarse, 4000);
  EXPECT_GT(coarse.triangles.size(), 3900U);
  EXPECT_TRUE(is_closed(coarse));
  EXPECT_LT(surface_distance_m(torus, coarse), 0.01 * torus_radius);
  const Mesh soap = scaled(bottle(), 0.001);
  const ModelMesh simple = simplified(soap, 4000);
  expect_sound(simple, 4000);
  EXPECT_LT(surface_distance_m(soap, simple), 0.003 * 0.126);
  // A thin wall stays two walls.
  const Mesh cup = scaled(mug(), 0.001);
  const ModelMesh thin = simplified(cup, 2000);
  expect_sound(thin, 2000);
  EXPECT_LT(surface_distance_m(cup, thin), 0.01 * 0.0636);
}

TEST(Simplify, FewerTrianglesMoreError) {
  const Mesh torus = bumpy_torus(80);
  double last = 0;
  for (const std::size_t most : {6000U, 2000U, 700U, 200U}) {
    const ModelMesh coarse = simplified(torus, most);
    expect_sound(coarse, most);
    EXPECT_TRUE(is_closed(coarse));
    const double error = surface_distance_m(torus, coarse);
    EXPECT_GT(error, last);
    last = error;
  }
  EXPECT_LT(last, 0.1 * 0.103);
}

TEST(Simplify, FlatPiecesCostNothing) {
  // A cube of 12 x 30 x 30 squares needs 12 triangles.
  Mesh grid;
  for (int side = 0; side < 6; ++side) {
    const Eigen::Vector3f out = (side % 2 == 0 ? 1.0F : -1.0F) * Eigen::Vector3f::Unit(side / 2);
    const Eigen::Vector3f x = Eigen::Vector3f::Unit((side / 2 + 1) % 3);
    const Eigen::Vector3f y = out.cross(x);
    MeshPart part;
    constexpr int kN = 30;
    const auto first = static_cast<std::uint32_t>(grid.vertices.size());
    for (int i = 0; i <= kN; ++i) {
      for (int k = 0; k <= kN; ++k) {
        grid.vertices.emplace_back(out + (2.0F * static_cast<float>(i) / kN - 1) * x +
                                   (2.0F * static_cast<float>(k) / kN - 1) * y);
        if (i == kN || k == kN) continue;
        const auto a = first + static_cast<std::uint32_t>(i * (kN + 1) + k);
        part.triangles.push_back({a, a + kN + 1, a + kN + 2});
        part.triangles.push_back({a, a + kN + 2, a + 1});
      }
    }
    grid.parts.push_back(part);
  }
  const ModelMesh coarse = simplified(grid, 60);
  expect_sound(coarse, 60);
  EXPECT_LT(surface_distance_m(grid, coarse), 2e-3);
}

TEST(Simplify, SmallMeshesPassThrough) {
  const ModelMesh same = simplified(box_mesh(1, 2, 3), 4000);
  EXPECT_EQ(same.triangles.size(), 12U);
  EXPECT_EQ(same.vertices.size(), 8U);
}

// Loose triangles cannot be collapsed edge by edge; the limit holds all the same.
TEST(Simplify, TheLimitHoldsForSoup) {
  Mesh soup;
  MeshPart part;
  std::mt19937_64 random(51);
  std::normal_distribution<float> normal;
  for (int i = 0; i < 6000; ++i) {
    const Eigen::Vector3f at = Eigen::Vector3f(normal(random), normal(random), normal(random)).normalized();
    const auto first = static_cast<std::uint32_t>(soup.vertices.size());
    for (int k = 0; k < 3; ++k) {
      soup.vertices.emplace_back(at +
                                 0.02F * Eigen::Vector3f(normal(random), normal(random), normal(random)));
    }
    part.triangles.push_back({first, first + 1, first + 2});
  }
  soup.parts.push_back(part);
  expect_sound(simplified(soup, 1000), 1000);
}

TEST(Simplify, HostileFansDoNotHang) {
  Mesh fan;
  MeshPart part;
  fan.vertices.emplace_back(0, 0, 0);
  for (std::uint32_t i = 1; i <= 60'000; ++i) {
    const double turn = 2 * std::numbers::pi * i / 60'000;
    fan.vertices.emplace_back(
        Eigen::Vector3d(std::cos(turn), std::sin(turn), 0.1 * std::sin(7 * turn)).cast<float>());
    part.triangles.push_back({0, i, i % 60'000 + 1});
  }
  fan.parts.push_back(part);
  expect_sound(simplified(fan, 1000), 1000);
}

TEST(Simplify, Deterministic) {
  const Mesh torus = bumpy_torus(60);
  const ModelMesh a = simplified(torus, 900);
  const ModelMesh b = simplified(torus, 900);
  EXPECT_EQ(a.vertices, b.vertices);
  EXPECT_EQ(a.triangles, b.triangles);
}

TEST(SurfaceDistance, SeesBothWays) {
  const Mesh box = box_mesh(1, 1, 1);
  ModelMesh same;
  same.vertices = box.vertices;
  same.triangles = box.parts[0].triangles;
  EXPECT_NEAR(surface_distance_m(box, same), 0, 1e-7);
  ModelMesh open = same;
  open.triangles.resize(10);  // one side is missing
  EXPECT_NEAR(surface_distance_m(box, open), 0.5, 0.01);
  ModelMesh spike = same;
  spike.vertices.emplace_back(0, 0, 3);
  spike.triangles.push_back({0, 1, 8});
  EXPECT_NEAR(surface_distance_m(box, spike), 2.5, 1e-6);
}

// A block cut into thousands of triangles needs twelve; a bumpy torus keeps what its bumps need.
TEST(SimplifiedWithin, TakesTheCoarsestThatFits) {
  Mesh block;
  MeshPart part;
  constexpr int kCuts = 20;
  for (int axis = 0; axis < 3; ++axis) {
    for (const float side : {-0.05F, 0.05F}) {
      const auto base = static_cast<std::uint32_t>(block.vertices.size());
      for (int i = 0; i <= kCuts; ++i) {
        for (int k = 0; k <= kCuts; ++k) {
          Eigen::Vector3f v;
          v[axis] = side;
          v[(axis + 1) % 3] = 0.1F * static_cast<float>(i) / kCuts - 0.05F;
          v[(axis + 2) % 3] = 0.1F * static_cast<float>(k) / kCuts - 0.05F;
          block.vertices.push_back(v);
        }
      }
      const auto at = [&](int i, int k) { return base + static_cast<std::uint32_t>(i * (kCuts + 1) + k); };
      for (int i = 0; i < kCuts; ++i) {
        for (int k = 0; k < kCuts; ++k) {
          part.triangles.push_back({at(i, k), at(i + 1, k), at(i + 1, k + 1)});
          part.triangles.push_back({at(i, k), at(i + 1, k + 1), at(i, k + 1)});
        }
      }
    }
  }
  block.normals.assign(block.vertices.size(), Eigen::Vector3f::UnitZ());
  block.colours.assign(block.vertices.size(), Eigen::Vector3f::Ones());
  block.uvs.assign(block.vertices.size(), Eigen::Vector2f::Zero());
  block.parts = {part};
  const ModelMesh simple = simplified_within(block, 0.0005, 4000);
  EXPECT_LE(simple.triangles.size(), 250U);
  EXPECT_LE(surface_distance_m(block, simple), 0.0005);

  const Mesh torus = bumpy_torus(60);
  const ModelMesh coarse = simplified_within(torus, 0.002, 4000);
  const ModelMesh fine = simplified_within(torus, 0.0003, 4000);
  EXPECT_LE(surface_distance_m(torus, coarse), 0.002);
  EXPECT_LT(coarse.triangles.size(), fine.triangles.size());
  EXPECT_EQ(simplified_within(torus, 0, 2000).triangles.size(), simplified(torus, 2000).triangles.size());
}

}  // namespace
}  // namespace sextant
