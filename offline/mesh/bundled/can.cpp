// SPDX-License-Identifier: Apache-2.0
// A food can: a textured label around it, beaded metal ends. Its shape is one of revolution, its print is
// not.
#include "offline/mesh/bundled/bundled_meshes.h"
#include "offline/mesh/bundled/canvas.h"
#include "offline/mesh/bundled/shapes.h"
#include "offline/mesh/normals.h"

namespace sextant {
namespace {

constexpr int kSegments = 64;
constexpr double kRadius = 33;
constexpr double kLabelLow = 5;
constexpr double kLabelHigh = 95;
constexpr double kAround = 207.345;  // 2 pi * 33

cv::Mat label() {
  const Paint red(188, 32, 38);
  const Paint dark_red(140, 20, 28);
  const Paint cream(250, 240, 214);
  const Paint green(52, 120, 52);
  const Paint ink(46, 36, 34);
  const Paint gold(226, 172, 60);
  constexpr double kHeight = kLabelHigh - kLabelLow;
  Canvas canvas(kAround, kHeight, 4);
  canvas.rectangle(0, 0, kAround, kHeight, red);
  canvas.rectangle(0, 5, kAround, 2.5, gold);
  canvas.rectangle(0, 82.5, kAround, 2.5, gold);
  // Front: brand on a cream shield, a tomato below.
  canvas.rectangle(14, 13, 76, 28, cream, 6);
  canvas.text("TOMATO", 52, 19, 16, red);
  canvas.disc(52, 62, 17, dark_red);
  canvas.disc(52, 62, 15.5, Paint(224, 62, 42));
  canvas.disc(46, 56, 4, Paint(244, 150, 120));
  for (const auto& leaf : {Eigen::Vector2d(40, 44), Eigen::Vector2d(52, 41), Eigen::Vector2d(64, 44)}) {
    canvas.line({{52, 49}, leaf}, 4, green);
  }
  // Back: a cream field with a table, a bar code and lines of text.
  canvas.rectangle(112, 13, 86, 64, cream, 3);
  for (int i = 0; i < 6; ++i) canvas.rectangle(117, 18 + 5.0 * i, i % 2 == 0 ? 32 : 26, 2.4, ink, 1);
  canvas.rectangle(117, 51, 34, 21, green, 2);
  canvas.text("400 G", 134, 57, 9, cream);
  canvas.bars(158, 20, 34, 24, "211321241231211321412", ink);
  canvas.polygon({{160, 72}, {176, 50}, {192, 72}}, gold);
  // A stripe where the label overlaps.
  canvas.rectangle(kAround - 4, 0, 4, kHeight, dark_red);
  return canvas.image();
}

}  // namespace

Mesh can() {
  const Eigen::Vector3f white(1, 1, 1);
  const auto plain = [&](double, std::size_t, double) { return white; };
  Mesh mesh;
  mesh.textures.push_back(label());
  const auto add = [&](const std::vector<ProfilePoint>& profile, int texture,
                       const Eigen::Vector3f& diffuse) {
    add_lathe(mesh, profile, kSegments, plain);
    mesh.parts.back().texture = texture;
    mesh.parts.back().diffuse = diffuse;
  };
  const Eigen::Vector3f steel(0.74F, 0.75F, 0.77F);
  add({{0, 2.5},
       {12, 2.5},
       {13, 3.2},
       {22, 3.2},
       {23, 2.5},
       {30, 2.5},
       {30.8, 0},
       {32.6, 0},
       {34, 1},
       {34, 3},
       {33, 4},
       {33, kLabelLow}},
      -1, steel);
  add({{kRadius, kLabelLow}, {kRadius, kLabelHigh}}, 0, white);
  add({{33, kLabelHigh},
       {33, 96},
       {34, 97},
       {34, 99},
       {32.6, 100},
       {30.8, 100},
       {30, 97.5},
       {23, 97.5},
       {22, 96.8},
       {13, 96.8},
       {12, 97.5},
       {0, 97.5}},
      -1, steel);
  complete_normals(mesh);
  share_equal_vertices(mesh);
  return mesh;
}

}  // namespace sextant
