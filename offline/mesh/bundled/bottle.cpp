// SPDX-License-Identifier: Apache-2.0
// A soap bottle with a cap and a handle. Vertex colours only: the label is made of the surface's own cells.
#include <cmath>
#include <numbers>

#include "offline/mesh/bundled/bundled_meshes.h"
#include "offline/mesh/bundled/canvas.h"
#include "offline/mesh/bundled/shapes.h"

namespace sextant {
namespace {

constexpr int kSegments = 72;
const Eigen::Vector3f kBody(0.10F, 0.42F, 0.62F);
const Eigen::Vector3f kBand(0.96F, 0.96F, 0.93F);
const Eigen::Vector3f kLetters(0.80F, 0.12F, 0.30F);
const Eigen::Vector3f kStripe(0.98F, 0.76F, 0.18F);
const Eigen::Vector3f kCap(0.93F, 0.36F, 0.12F);

// Rows of the label between 42 and 110 mm, 20 of them; columns are the 72 segments.
constexpr double kLabelLow = 42;
constexpr double kLabelHigh = 110;
constexpr int kRows = 20;

// Whether a cell lies on a letter drawn on the font's grid, five columns by seven rows.
bool on_letter(char letter, int column, int row) {
  const Eigen::Vector2d p(column, row);
  for (const auto& stroke : letter_strokes(letter)) {
    for (std::size_t i = 0; i + 1 < stroke.size(); ++i) {
      const Eigen::Vector2d along = stroke[i + 1] - stroke[i];
      const double t = std::clamp((p - stroke[i]).dot(along) / along.squaredNorm(), 0.0, 1.0);
      if ((p - stroke[i] - t * along).norm() < 0.45) return true;
    }
  }
  return false;
}

Eigen::Vector3f label_colour(int column, int row) {
  if (row < 1 || row >= kRows - 1) return kStripe;
  // The word towards -y, which is opposite to nothing: the handle is at +x. Columns count from +x over +y.
  const int across = column - (54 - 12);
  if (row >= 6 && row < 13 && across >= 0 && across < 24 && across % 6 < 5) {
    if (on_letter("SOAP"[across / 6], across % 6, row - 6)) return kLetters;
  }
  // Towards +y a chequered field, towards -x a block.
  if (column >= 11 && column < 26 && row >= 4 && row < 16 && (column / 3 + row / 3) % 2 == 0) return kBody;
  if (column >= 33 && column < 38 && row >= 4 && row < 16) return kStripe;
  return kBand;
}

}  // namespace

Mesh bottle() {
  Mesh mesh;
  const auto one = [](const Eigen::Vector3f& colour) {
    return [colour](double, std::size_t, double) { return colour; };
  };
  add_lathe(mesh,
            smooth_profile({{0, 4}, {26, 3}, {34, 0.5}, {39, 3}, {41, 12}, {42, 27}, {42, kLabelLow}}, 2),
            kSegments, one(kBody));
  std::vector<ProfilePoint> label;
  for (int i = 0; i <= kRows; ++i) label.push_back({42, kLabelLow + (kLabelHigh - kLabelLow) * i / kRows});
  add_lathe(mesh, label, kSegments, [&](double turn, std::size_t band, double) {
    return label_colour(static_cast<int>(turn * kSegments), kRows - 1 - static_cast<int>(band));
  });
  add_lathe(
      mesh,
      smooth_profile({{42, kLabelHigh}, {42, 128}, {38, 148}, {27, 172}, {18, 192}, {15, 206}, {15, 214}}, 3),
      kSegments, one(kBody));
  add_lathe(mesh,
            {{15, 214}, {19, 214}, {20, 215}, {20, 234}, {17, 238}, {9, 239}, {8, 247}, {7, 248}, {0, 248}},
            kSegments, one(kCap));
  // The handle: out of the shoulder, down, and back into the body.
  std::vector<Eigen::Vector3d> path;
  constexpr int kSteps = 28;
  for (int i = 0; i <= kSteps; ++i) {
    const double t = std::numbers::pi * (static_cast<double>(i) / kSteps - 0.5);
    const double from = 12 + 24.0 * i / kSteps;  // inside of the slim shoulder above, of the body below
    path.emplace_back(from + (70 - from) * std::pow(std::cos(t), 0.7), 0, 146 - 42 * std::sin(t));
  }
  add_tube(mesh, path, 9, 7, {0, 1, 0}, 16, kBody);
  return mesh;
}

}  // namespace sextant
