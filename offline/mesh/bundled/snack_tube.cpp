// SPDX-License-Identifier: Apache-2.0
// A tall tube of crisps: printed wrapper, metal foot, plastic lid.
#include "offline/mesh/bundled/bundled_meshes.h"
#include "offline/mesh/bundled/canvas.h"
#include "offline/mesh/bundled/shapes.h"
#include "offline/mesh/normals.h"

namespace sextant {
namespace {

constexpr int kSegments = 56;
constexpr double kRadius = 37;
constexpr double kLow = 4;
constexpr double kHigh = 222;
constexpr double kAround = 232.478;  // 2 pi * 37

cv::Mat wrapper() {
  const Paint blue(28, 66, 140);
  const Paint sky(110, 176, 222);
  const Paint yellow(248, 204, 70);
  const Paint brown(150, 88, 40);
  const Paint white(250, 250, 246);
  const Paint ink(34, 34, 40);
  constexpr double kHeight = kHigh - kLow;
  Canvas canvas(kAround, kHeight, 2.5);
  canvas.rectangle(0, 0, kAround, kHeight, blue);
  canvas.rectangle(0, 0, kAround, 16, yellow);
  // Front: name, a heap of crisps.
  canvas.rectangle(12, 30, 84, 34, white, 8);
  canvas.text("CRISP", 54, 38, 18, blue);
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k <= i; ++k)
      canvas.disc(54 + 24.0 * (k - 0.5 * i), 100 + 26.0 * i, 15, i % 2 == 0 ? yellow : sky);
  }
  for (int i = 0; i < 3; ++i) canvas.ring(30 + 24.0 * i, 152, 15, 2, brown);
  canvas.text("SALT", 54, 186, 14, yellow);
  // Back: text, table, bar code.
  canvas.rectangle(126, 28, 94, 176, white, 4);
  for (int i = 0; i < 8; ++i) canvas.rectangle(134, 38 + 8.0 * i, i % 3 == 1 ? 64 : 76, 3.4, ink, 1);
  canvas.rectangle(134, 112, 46, 50, sky, 3);
  canvas.rectangle(138, 116, 38, 8, blue);
  canvas.rectangle(138, 128, 38, 30, white);
  canvas.bars(146, 172, 56, 24, "2113212412312113214121", ink);
  canvas.rectangle(104, 16, 10, kHeight - 16, sky);
  return canvas.image();
}

}  // namespace

Mesh snack_tube() {
  const auto plain = [](double, std::size_t, double) { return Eigen::Vector3f(1, 1, 1); };
  Mesh mesh;
  mesh.textures.push_back(wrapper());
  const auto add = [&](const std::vector<ProfilePoint>& profile, int texture,
                       const Eigen::Vector3f& diffuse) {
    add_lathe(mesh, profile, kSegments, plain);
    mesh.parts.back().texture = texture;
    mesh.parts.back().diffuse = diffuse;
  };
  add({{0, 3}, {33, 3}, {34, 0}, {37.6, 0}, {37.6, 3}, {kRadius, kLow}}, -1, {0.72F, 0.73F, 0.75F});
  add({{kRadius, kLow}, {kRadius, kHigh}}, 0, {1, 1, 1});
  add({{kRadius, kHigh}, {39, kHigh}, {39, 232}, {37.5, 233.5}, {34, 233.5}, {33, 231}, {0, 231}}, -1,
      {0.93F, 0.93F, 0.90F});
  complete_normals(mesh);
  share_equal_vertices(mesh);
  return mesh;
}

}  // namespace sextant
