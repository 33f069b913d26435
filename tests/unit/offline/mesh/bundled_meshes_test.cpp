// SPDX-License-Identifier: Apache-2.0
#include "offline/mesh/bundled/bundled_meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "offline/mesh/bundled/canvas.h"
#include "offline/mesh/mass.h"
#include "offline/mesh/mesh_reader.h"
#include "offline/mesh/texture.h"
#include "tests/unit/offline/mesh/test_files.h"

namespace sextant {
namespace {

TEST(BundledMeshes, RegeneratingGivesTheCommittedBytes) {
  std::size_t total = 0;
  for (const auto& [name, bytes] : bundled_mesh_files()) {
    const std::string committed = file_content(repository_file("data/meshes/" + name));
    total += bytes.size();
    ASSERT_EQ(committed.size(), bytes.size()) << name << ": run sextant-make-meshes data/meshes";
    EXPECT_EQ(std::memcmp(committed.data(), bytes.data(), bytes.size()), 0) << name;
  }
  EXPECT_LT(total, 1'500'000U);
}

TEST(BundledMeshes, AreClosedAndOfModestSize) {
  for (const Mesh& mesh :
       {printed_box(), tea_box(), can(), snack_tube(), bottle(), sauce_bottle(), mug(), drill()}) {
    EXPECT_EQ(free_edge_length(mesh), 0);
    EXPECT_LT(mesh.triangle_count(), 10'000U);
  }
}

// As the reader does it: parts of one look become one.
Mesh with_equal_looks_joined(Mesh mesh) {
  std::vector<MeshPart> parts;
  for (const MeshPart& part : mesh.parts) {
    const auto same = std::find_if(parts.begin(), parts.end(), [&](const MeshPart& p) {
      return p.texture == part.texture && p.diffuse == part.diffuse;
    });
    if (same == parts.end()) {
      parts.push_back(part);
    } else {
      same->triangles.insert(same->triangles.end(), part.triangles.begin(), part.triangles.end());
    }
  }
  mesh.parts = parts;
  return mesh;
}

// What the file says after its journey through the reader is what was made.
TEST(BundledMeshes, SurviveTheirFormats) {
  const auto expect_same = [](const Mesh& made, const Mesh& read, bool y_up) {
    EXPECT_EQ(made.triangle_count(), read.triangle_count());
    ASSERT_EQ(made.parts.size(), read.parts.size());
    for (std::size_t i = 0; i < made.parts.size(); ++i) {
      ASSERT_EQ(made.parts[i].triangles.size(), read.parts[i].triangles.size());
      EXPECT_EQ(made.parts[i].texture, read.parts[i].texture);
      EXPECT_LT((made.parts[i].diffuse - read.parts[i].diffuse).norm(), 1e-3F);
      for (std::size_t t = 0; t < made.parts[i].triangles.size(); ++t) {
        for (std::size_t k = 0; k < 3; ++k) {
          const auto a = made.parts[i].triangles[t].at(k);
          const auto b = read.parts[i].triangles[t].at(k);
          const auto turned = [&](const Eigen::Vector3f& p) {
            return y_up ? Eigen::Vector3f(p.x(), p.z(), -p.y()) : p;
          };
          ASSERT_LT((turned(made.vertices[a]) * 0.001F - read.vertices[b]).norm(), 1e-6F);
          ASSERT_LT((made.colours[a] - read.colours[b]).cwiseAbs().maxCoeff(), 0.6F / 255);
          if (made.parts[i].texture >= 0) {
            ASSERT_LT((made.uvs[a] - read.uvs[b]).norm(), 1e-5F);
          }
        }
      }
    }
    ASSERT_EQ(made.textures.size(), read.textures.size());
    for (std::size_t i = 0; i < made.textures.size(); ++i) {
      EXPECT_EQ(std::memcmp(made.textures[i].data, read.textures[i].data, made.textures[i].total() * 3), 0);
    }
  };
  expect_same(printed_box(), read_mesh(repository_file("data/meshes/printed_box.obj"), 0.001), false);
  expect_same(with_equal_looks_joined(can()), read_mesh(repository_file("data/meshes/can.glb")), true);
  expect_same(tea_box(), read_mesh(repository_file("data/meshes/tea_box.obj"), 0.001), false);
  expect_same(with_equal_looks_joined(snack_tube()), read_mesh(repository_file("data/meshes/snack_tube.glb")),
              true);
  expect_same(with_equal_looks_joined(sauce_bottle()),
              read_mesh(repository_file("data/meshes/sauce_bottle.glb")), true);
  expect_same(with_equal_looks_joined(drill()), read_mesh(repository_file("data/meshes/drill.ply"), 0.001),
              false);
  expect_same(with_equal_looks_joined(bottle()), read_mesh(repository_file("data/meshes/bottle.ply"), 0.001),
              false);
}

TEST(Canvas, ShapesCoverTheirArea) {
  const auto dark_area = [](const Canvas& canvas, double pixels_per_mm) {
    double sum = 0;
    const cv::Mat image = canvas.image();
    for (int y = 0; y < image.rows; ++y) {
      for (int x = 0; x < image.cols; ++x) sum += 1 - image.at<cv::Vec3b>(y, x)[0] / 255.0;
    }
    return sum / (pixels_per_mm * pixels_per_mm);
  };
  const Paint black(0, 0, 0);
  const auto area_of = [&](const auto& draw) {
    Canvas canvas(60, 40, 4);
    draw(canvas);
    return dark_area(canvas, 4);
  };
  EXPECT_NEAR(area_of([&](Canvas& c) { c.rectangle(3.3, 4.1, 20.7, 11.2, black); }), 20.7 * 11.2, 1.5);
  EXPECT_NEAR(area_of([&](Canvas& c) { c.disc(20, 20, 10, black); }), 314.16, 1);
  EXPECT_NEAR(area_of([&](Canvas& c) { c.ring(20, 20, 10, 2, black); }), 125.66, 1);
  EXPECT_NEAR(area_of([&](Canvas& c) { c.polygon({{5, 5}, {35, 5}, {5, 25}}, black); }), 300, 3);
  EXPECT_NEAR(area_of([&](Canvas& c) { c.line({{10, 10}, {40, 10}}, 4, black); }), 120 + 12.57, 1);
  EXPECT_NEAR(area_of([&](Canvas& c) {
                c.panel(10, 10, 10, 10);
                c.rectangle(-50, -50, 500, 500, black);
              }),
              100, 0.1);
}

TEST(Canvas, PaintsWhereItIsTold) {
  Canvas canvas(20, 10, 5);
  canvas.rectangle(5, 2, 3, 3, Paint(10, 200, 30));
  EXPECT_TRUE(canvas.at(6, 3).isApprox(Paint(10, 200, 30)));
  EXPECT_TRUE(canvas.at(10, 3).isApprox(Paint(255, 255, 255)));
  const cv::Mat image = canvas.image();
  EXPECT_EQ(image.at<cv::Vec3b>(15, 30), cv::Vec3b(10, 200, 30));
  EXPECT_EQ(image.size(), cv::Size(100, 50));
}

}  // namespace
}  // namespace sextant
