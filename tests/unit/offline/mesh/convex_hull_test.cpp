// SPDX-License-Identifier: Apache-2.0
#include "offline/mesh/convex_hull.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>

#include "offline/mesh/mass.h"
#include "tests/unit/offline/mesh/test_files.h"

namespace sextant {
namespace {

using Eigen::Vector3d;
using Points = std::vector<Vector3d>;

Points points_of(const Mesh& mesh) {
  Points points;
  for (const auto& p : mesh.vertices) points.push_back(p.cast<double>());
  return points;
}

// Closed, outside out, convex, and around all points.
void expect_hull_of(const ConvexHull& hull, const Points& points, double tolerance) {
  for (const ConvexHull::Facet& facet : hull.facets) {
    const Vector3d& a = hull.vertices[facet.corners[0]];
    const Vector3d turn = (hull.vertices[facet.corners[1]] - a).cross(hull.vertices[facet.corners[2]] - a);
    EXPECT_NEAR(facet.normal.norm(), 1, 1e-9);
    EXPECT_GE(turn.dot(facet.normal), -1e-12);
    for (const Vector3d& p : points) {
      ASSERT_LE(facet.normal.dot(p - a), tolerance);
    }
    for (std::size_t k = 0; k < 3; ++k) {
      ASSERT_LT(facet.across.at(k), hull.facets.size());
      const ConvexHull::Facet& other = hull.facets[facet.across.at(k)];
      int shared = 0;
      for (const auto v : other.corners)
        shared += v == facet.corners.at(k) || v == facet.corners.at((k + 1) % 3);
      EXPECT_EQ(shared, 2);
    }
  }
  // Euler: a closed surface without holes.
  EXPECT_EQ(hull.facets.size(), 2 * hull.vertices.size() - 4);
}

TEST(ConvexHull, RandomCloudsAreEnclosed) {
  std::mt19937_64 random(21);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 40; ++i) {
    Points points;
    for (int k = 0; k < 4 + i * 5; ++k)
      points.emplace_back(normal(random), 0.1 * normal(random), 3 * normal(random));
    const auto hull = convex_hull(points);
    ASSERT_TRUE(hull);
    expect_hull_of(*hull, points, 1e-9);
  }
}

TEST(ConvexHull, SolidsKnownByHand) {
  for (const double scale : {1e-3, 1.0, 1e3}) {
    const Points box = points_of(moved(box_mesh(scale, 2 * scale, 3 * scale), Vector3d(scale, 0, 0)));
    const auto hull = convex_hull(box);
    ASSERT_TRUE(hull);
    expect_hull_of(*hull, box, 1e-6 * scale);
    const Solid solid = solid_of(*hull);
    EXPECT_NEAR(solid.volume / (6 * scale * scale * scale), 1, 1e-6);
    EXPECT_LT((solid.centre - Vector3d(scale, 0, 0)).norm(), 1e-6 * scale);
  }
  // A cone's centre of mass lies at a quarter of its height.
  Points cone{{0, 0, 1}};
  for (int k = 0; k < 500; ++k) {
    const double turn = 2 * std::numbers::pi * k / 500;
    cone.emplace_back(std::cos(turn), std::sin(turn), 0);
  }
  EXPECT_NEAR(solid_of(*convex_hull(cone)).centre.z(), 0.25, 1e-9);
}

TEST(ConvexHull, FlatThingsHaveNone) {
  EXPECT_FALSE(convex_hull({}));
  EXPECT_FALSE(convex_hull({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
  Points plate;
  for (int i = 0; i < 50; ++i) plate.emplace_back(i % 7, i / 7, 0.5 * (i % 7));
  EXPECT_FALSE(convex_hull(plate));
  EXPECT_FALSE(convex_hull(Points(10, Vector3d(1, 1, 1))));
}

TEST(ConvexHull, OfVeryManyPointsIsAlmostExact) {
  std::mt19937_64 random(22);
  std::normal_distribution<double> normal;
  Points points = points_of(box_mesh(1, 2, 3));
  const Vector3d half(0.5, 1, 1.5);
  for (int k = 0; k < 150'000; ++k) {
    Vector3d p(normal(random), normal(random), normal(random));
    p /= p.cwiseAbs().cwiseQuotient(half).maxCoeff();  // on the box
    points.push_back(p);
  }
  const auto hull = convex_hull(points);
  ASSERT_TRUE(hull);
  EXPECT_NEAR(solid_of(*hull).volume, 6, 6e-3);
  for (const ConvexHull::Facet& facet : hull->facets) {
    for (std::size_t k = 0; k < points.size(); k += 97) {
      ASSERT_LE(facet.normal.dot(points[k] - hull->vertices[facet.corners[0]]), 3e-3);
    }
  }
}

TEST(CentreOfMass, OfClosedMeshesIsThatOfTheirSolid) {
  // A box with a small box glued to its side: hull and solid differ.
  const Mesh mesh = joined(box_mesh(1, 1, 1), moved(box_mesh(1, 0.5, 0.5), {1, 0, 0}));
  const auto hull = convex_hull(points_of(mesh));
  ASSERT_TRUE(hull);
  EXPECT_NEAR(centre_of_mass(mesh, *hull).x(), 0.25 / 1.25, 1e-6);
  Mesh inside_out = mesh;
  for (MeshPart& part : inside_out.parts) {
    for (auto& t : part.triangles) std::swap(t[0], t[1]);
  }
  EXPECT_NEAR(centre_of_mass(inside_out, *hull).x(), 0.2, 1e-6);
  EXPECT_EQ(free_edge_length(mesh), 0);
}

TEST(CentreOfMass, OfOpenMeshesIsThatOfTheirHull) {
  Mesh open = cylinder_mesh(1, 2, 40);
  std::vector<std::array<std::uint32_t, 3>> kept;
  for (const auto& t : open.parts[0].triangles) {
    if (t[0] != 1) kept.push_back(t);  // without the lid
  }
  open.parts[0].triangles = kept;
  EXPECT_NEAR(free_edge_length(open), 2 * std::numbers::pi, 0.02);
  const auto hull = convex_hull(points_of(open));
  ASSERT_TRUE(hull);
  EXPECT_LT(centre_of_mass(open, *hull).norm(), 1e-6);
  // Every triangle twice, back to back: encloses nothing.
  Mesh sheet = box_mesh(1, 1, 1);
  const auto triangles = sheet.parts[0].triangles;
  for (auto t : triangles) {
    std::swap(t[0], t[1]);
    sheet.parts[0].triangles.push_back(t);
  }
  EXPECT_LT(centre_of_mass(sheet, *convex_hull(points_of(sheet))).norm(), 1e-9);
}

}  // namespace
}  // namespace sextant
