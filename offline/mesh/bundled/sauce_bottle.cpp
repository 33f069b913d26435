// SPDX-License-Identifier: Apache-2.0
// A squeeze bottle of mustard: round body, printed label on its front half, nozzle.
#include "offline/mesh/bundled/bundled_meshes.h"
#include "offline/mesh/bundled/canvas.h"
#include "offline/mesh/bundled/shapes.h"
#include "offline/mesh/normals.h"

namespace sextant {
namespace {

constexpr int kSegments = 56;
constexpr double kRadius = 31;
constexpr double kLow = 38;
constexpr double kHigh = 112;
constexpr double kAround = 194.779;  // 2 pi * 31

const Paint kYellow(238, 190, 40);

cv::Mat label() {
  const Paint red(186, 34, 30);
  const Paint white(250, 248, 240);
  const Paint green(40, 104, 60);
  const Paint ink(40, 38, 30);
  constexpr double kHeight = kHigh - kLow;
  Canvas canvas(kAround, kHeight, 2.5);
  canvas.rectangle(0, 0, kAround, kHeight, kYellow);
  canvas.rectangle(8, 4, 100, 66, white, 9);
  canvas.rectangle(12, 8, 92, 20, red, 6);
  canvas.text("MUSTARD", 58, 12, 12, white);
  canvas.disc(36, 48, 14, kYellow);
  canvas.ring(36, 48, 14, 2, red);
  canvas.line({{60, 62}, {76, 36}}, 3, green);
  canvas.disc(78, 34, 5, green);
  canvas.disc(86, 48, 6, red);
  for (int i = 0; i < 5; ++i) canvas.rectangle(128, 12 + 7.0 * i, 44, 3, ink, 1);
  canvas.bars(132, 50, 36, 18, "211321241231211321", ink);
  return canvas.image();
}

}  // namespace

Mesh sauce_bottle() {
  const auto plain = [](double, std::size_t, double) { return Eigen::Vector3f(1, 1, 1); };
  Mesh mesh;
  mesh.textures.push_back(label());
  const auto add = [&](const std::vector<ProfilePoint>& profile, int texture,
                       const Eigen::Vector3f& diffuse) {
    add_lathe(mesh, profile, kSegments, plain);
    mesh.parts.back().texture = texture;
    mesh.parts.back().diffuse = diffuse;
  };
  const Eigen::Vector3f yellow = (kYellow / 255).cast<float>();
  add(smooth_profile({{0, 4}, {20, 3}, {26, 0.5}, {29.5, 3}, {31, 12}, {31, 26}, {kRadius, kLow}}, 2), -1,
      yellow);
  add({{kRadius, kLow}, {kRadius, kHigh}}, 0, {1, 1, 1});
  add(smooth_profile({{kRadius, kHigh}, {31, 122}, {28, 136}, {21, 148}, {18, 152}, {18, 156}}, 3), -1,
      yellow);
  add({{18, 156}, {20, 156}, {20, 172}, {10, 175}, {6, 190}, {3, 193}, {0, 193}}, -1, {0.78F, 0.16F, 0.12F});
  complete_normals(mesh);
  share_equal_vertices(mesh);
  return mesh;
}

}  // namespace sextant
