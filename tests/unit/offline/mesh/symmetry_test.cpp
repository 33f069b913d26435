// SPDX-License-Identifier: Apache-2.0
#include "offline/mesh/symmetry.h"

#include <gtest/gtest.h>

#include <cmath>

#include "offline/mesh/normals.h"
#include "tests/unit/offline/mesh/test_files.h"

namespace sextant {
namespace {

double radius_of(const Mesh& mesh) {
  double radius = 0;
  for (const auto& p : mesh.vertices) radius = std::max(radius, static_cast<double>(p.norm()));
  return radius;
}

std::pair<int, int> symmetry_of(const Mesh& mesh) {
  const TurnSymmetry found = detect_turn_symmetry(mesh, radius_of(mesh));
  return {found.with_print_deg, found.of_shape_deg};
}

using Pair = std::pair<int, int>;

TEST(TurnSymmetry, PrismsByTheirSides) {
  EXPECT_EQ(symmetry_of(box_mesh(1, 2, 3)), Pair(180, 180));
  EXPECT_EQ(symmetry_of(box_mesh(2, 2, 3)), Pair(90, 90));
  EXPECT_EQ(symmetry_of(box_mesh(2, 2.3, 3)), Pair(180, 180));
  EXPECT_EQ(symmetry_of(cylinder_mesh(1, 2, 3)), Pair(360, 360));
  EXPECT_EQ(symmetry_of(cylinder_mesh(1, 2, 5)), Pair(360, 360));
  EXPECT_EQ(symmetry_of(cylinder_mesh(1, 2, 6)), Pair(180, 180));
  EXPECT_EQ(symmetry_of(cylinder_mesh(1, 2, 8)), Pair(90, 90));
  EXPECT_EQ(symmetry_of(cylinder_mesh(1, 2, 32)), Pair(0, 0));
  EXPECT_EQ(symmetry_of(cylinder_mesh(1, 0.3, 64)), Pair(0, 0));
}

TEST(TurnSymmetry, AHandleBreaksIt) {
  const Mesh mug = joined(cylinder_mesh(1, 2, 48), moved(box_mesh(0.6, 0.2, 1), {1.1, 0, 0}));
  EXPECT_EQ(symmetry_of(mug), Pair(360, 360));
  const Mesh pot = joined(mug, moved(box_mesh(0.6, 0.2, 1), {-1.1, 0, 0}));
  EXPECT_EQ(symmetry_of(pot), Pair(180, 180));
}

TEST(TurnSymmetry, AnAxisBesideTheMiddleIsNone) {
  EXPECT_EQ(symmetry_of(moved(cylinder_mesh(1, 2, 48), {0.1, 0, 0})), Pair(360, 360));
}

// Colours by vertex: one strip of the barrel, from bottom to top.
Mesh with_stripe(Mesh mesh, double from_deg, double to_deg) {
  Mesh out;
  out.parts.resize(1);
  for (const auto& t : mesh.parts[0].triangles) {
    Eigen::Vector3f middle(0, 0, 0);
    for (const auto v : t) middle += mesh.vertices[v] / 3;
    const double turn = std::atan2(middle.y(), middle.x()) * 180 / 3.14159265358979;
    const bool on_barrel = std::hypot(middle.x(), middle.y()) > 0.8;
    const Eigen::Vector3f colour = on_barrel && turn >= from_deg && turn < to_deg
                                       ? Eigen::Vector3f(0.2F, 0.3F, 1)
                                       : Eigen::Vector3f(1, 1, 1);
    std::array<std::uint32_t, 3> corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      corners.at(k) = static_cast<std::uint32_t>(out.vertices.size());
      out.vertices.push_back(mesh.vertices[t.at(k)]);
      out.normals.emplace_back(0, 0, 1);
      out.colours.push_back(colour);
      out.uvs.emplace_back(0, 0);
    }
    out.parts[0].triangles.push_back(corners);
  }
  return out;
}

TEST(TurnSymmetry, APrintBreaksItWithoutChangingTheShape) {
  EXPECT_EQ(symmetry_of(with_stripe(cylinder_mesh(1, 2, 48), 10, 40)), Pair(360, 0));
  EXPECT_EQ(symmetry_of(with_stripe(cylinder_mesh(1, 2, 48), -200, 200)), Pair(0, 0));
  EXPECT_EQ(symmetry_of(with_stripe(box_mesh(2, 2, 3), -45, 45)), Pair(360, 90));
}

TEST(TurnSymmetry, TextureCounts) {
  // A box whose sides all show the whole texture, upright: what is on the texture repeats every 90 deg.
  Mesh mesh;
  MeshPart part;
  part.texture = 0;
  const float corners[4][2] = {{1, -1}, {1, 1}, {-1, 1}, {-1, -1}};
  for (int s = 0; s < 4; ++s) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (int k = 0; k < 4; ++k) {
      const float* c = corners[(s + (k == 1 || k == 2)) % 4];
      mesh.vertices.emplace_back(c[0], c[1], k >= 2 ? 1.0F : -1.0F);
      mesh.normals.emplace_back(0, 0, 1);
      mesh.colours.emplace_back(1, 1, 1);
      mesh.uvs.emplace_back(k == 1 || k == 2 ? 1.0F : 0.0F, k >= 2 ? 1.0F : 0.0F);
    }
    part.triangles.push_back({first, first + 1, first + 2});
    part.triangles.push_back({first, first + 2, first + 3});
  }
  mesh.parts.push_back(part);
  cv::Mat image(16, 16, CV_8UC3, cv::Scalar(255, 255, 255));
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 7; ++x) image.at<cv::Vec3b>(y, x) = {200, 30, 30};
  }
  mesh.textures.push_back(image);
  EXPECT_EQ(symmetry_of(mesh), Pair(90, 90));
  // One side without the print.
  mesh.parts.push_back({{mesh.parts[0].triangles[0], mesh.parts[0].triangles[1]}, -1, {1, 1, 1}});
  mesh.parts[0].triangles.erase(mesh.parts[0].triangles.begin(), mesh.parts[0].triangles.begin() + 2);
  EXPECT_EQ(symmetry_of(mesh), Pair(360, 90));
  // Two opposite sides without it.
  mesh.parts[1].triangles.push_back(mesh.parts[0].triangles[2]);
  mesh.parts[1].triangles.push_back(mesh.parts[0].triangles[3]);
  mesh.parts[0].triangles.erase(mesh.parts[0].triangles.begin() + 2, mesh.parts[0].triangles.begin() + 4);
  EXPECT_EQ(symmetry_of(mesh), Pair(180, 90));
}

TEST(SurfaceColour, BilinearRowsFromTheTop) {
  Mesh mesh = box_mesh(1, 1, 1);
  cv::Mat image(2, 2, CV_8UC3);
  image.at<cv::Vec3b>(0, 0) = {255, 0, 0};
  image.at<cv::Vec3b>(0, 1) = {0, 255, 0};
  image.at<cv::Vec3b>(1, 0) = {0, 0, 255};
  image.at<cv::Vec3b>(1, 1) = {255, 255, 255};
  mesh.textures.push_back(image);
  MeshPart part{{}, 0, {1, 0.5F, 1}};
  const std::array<std::uint32_t, 3> t{0, 1, 2};
  const auto at = [&](float u, float v) {
    for (int k = 0; k < 3; ++k) mesh.uvs[static_cast<std::size_t>(k)] = {u, v};
    return surface_colour(mesh, part, t, {0.2, 0.3, 0.5});
  };
  EXPECT_TRUE(at(0.25F, 0.75F).isApprox(Eigen::Vector3f(1, 0, 0), 1e-5F));
  EXPECT_TRUE(at(0.75F, 0.75F).isApprox(Eigen::Vector3f(0, 0.5F, 0), 1e-5F));
  EXPECT_TRUE(at(0.25F, 0.25F).isApprox(Eigen::Vector3f(0, 0, 1), 1e-5F));
  EXPECT_TRUE(at(-0.75F, 3.75F).isApprox(Eigen::Vector3f(1, 0, 0), 1e-5F));
  EXPECT_TRUE(at(0.5F, 0.75F).isApprox(Eigen::Vector3f(0.5F, 0.25F, 0), 1e-5F));
}

}  // namespace
}  // namespace sextant
