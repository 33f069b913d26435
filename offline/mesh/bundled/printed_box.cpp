// SPDX-License-Identifier: Apache-2.0
// A carton of oats with a different print on each of its six sides.
#include <cstdlib>

#include "offline/mesh/bundled/bundled_meshes.h"
#include "offline/mesh/bundled/carton.h"

namespace sextant {
namespace {

constexpr double kWidth = 160;   // x
constexpr double kDepth = 60;    // y
constexpr double kHeight = 210;  // z
constexpr CartonSize kSize{kWidth, kDepth, kHeight};

const Paint kNavy(22, 48, 92);
const Paint kSky(92, 170, 214);
const Paint kCream(248, 238, 214);
const Paint kSun(250, 180, 40);
const Paint kOrange(232, 104, 36);
const Paint kTeal(18, 120, 116);
const Paint kRed(196, 40, 44);
const Paint kInk(40, 36, 34);

void enter(Canvas& canvas, CartonSide side) {
  const CartonPanel p = carton_panel(kSize, side);
  canvas.panel(p.x, p.y, p.width, p.height);
}

void sun(Canvas& canvas, double x, double y, double radius, const Paint& ray, const Paint& disc) {
  // Cosines of 0, 22.5 .. 90 deg as numbers: the last digit of a computed one differs between machines.
  constexpr double kCosine[] = {1,          0.9238795,  0.7071068,  0.3826834, 0,
                                -0.3826834, -0.7071068, -0.9238795, -1};
  const Eigen::Vector2d middle(x, y);
  for (int i = 0; i < 16; ++i) {
    const int from_x = i <= 8 ? i : 16 - i;
    const int from_y = i <= 12 ? std::abs(i - 4) : 20 - i;
    const Eigen::Vector2d out(kCosine[from_x], kCosine[from_y]);
    const Eigen::Vector2d side = 0.11 * radius * Eigen::Vector2d(-out.y(), out.x());
    const Eigen::Vector2d base = middle + 1.12 * radius * out;
    canvas.polygon({base - side, base + side, middle + (i % 2 == 0 ? 1.75 : 1.45) * radius * out}, ray);
  }
  canvas.disc(x, y, radius, disc);
}

void paint_front(Canvas& canvas) {
  enter(canvas, CartonSide::kFront);
  canvas.rectangle(0, 0, kWidth, kHeight, kNavy);
  canvas.rectangle(0, 62, kWidth, 84, kSky);
  sun(canvas, 80, 118, 31, kCream, kSun);
  canvas.ring(80, 118, 24, 2.5, kOrange);
  canvas.line({{80, 97}, {80, 139}}, 2.2, kOrange);
  canvas.line({{59, 118}, {101, 118}}, 2.2, kOrange);
  // The sea: two rows of waves over the lower part of the sun.
  canvas.rectangle(0, 142, kWidth, 68, kTeal);
  for (int i = 0; i < 8; ++i) canvas.disc(10 + 20.0 * i, 142, 10, kTeal);
  for (int i = 0; i < 9; ++i) canvas.ring(20.0 * i, 160, 9, 2, kSky);
  canvas.rectangle(0, 161, kWidth, 49, kTeal);
  canvas.text("SEXTANT", 80, 17, 22, kCream);
  canvas.text("ROLLED OATS", 80, 46, 9, kSun);
  canvas.rectangle(34, 170, 92, 27, kCream, 6);
  canvas.text("500 G", 80, 176, 15, kRed);
}

void paint_back(Canvas& canvas) {
  enter(canvas, CartonSide::kBack);
  canvas.rectangle(0, 0, kWidth, kHeight, kCream);
  canvas.rectangle(0, 0, kWidth, 34, kOrange);
  canvas.text("GOOD MORNING", 80, 10, 13, kCream);
  // Lines of text are bars: nobody reads them at this distance.
  const double lengths[] = {62, 58, 64, 55, 60, 63, 40};
  for (int i = 0; i < 7; ++i) canvas.rectangle(12, 46 + 8.0 * i, lengths[i], 3.6, kInk, 1.5);
  canvas.rectangle(88, 44, 60, 60, kSky, 4);
  canvas.disc(118, 80, 20, kCream);
  canvas.disc(118, 76, 15, kSun);
  canvas.rectangle(96, 76, 44, 5, kRed, 2);
  canvas.polygon({{98, 81}, {138, 81}, {128, 98}, {108, 98}}, kRed);
  canvas.rectangle(12, 114, 74, 82, kInk, 2);
  canvas.rectangle(13.5, 115.5, 71, 79, kCream, 1);
  canvas.rectangle(12, 114, 74, 12, kInk, 2);
  for (int i = 0; i < 7; ++i) {
    canvas.rectangle(18, 131 + 9.0 * i, 30 - 3.0 * (i % 3), 3.2, kInk, 1.4);
    canvas.rectangle(68, 131 + 9.0 * i, 12, 3.2, kInk, 1.4);
  }
  canvas.rectangle(96, 150, 54, 46, Paint(255, 255, 255));
  canvas.bars(101, 155, 44, 30, "2113212412312113214121122131213", kInk);
  canvas.text("412 0051 2", 123, 188, 5, kInk);
}

void paint_sides(Canvas& canvas) {
  enter(canvas, CartonSide::kRight);
  canvas.rectangle(0, 0, kDepth, kHeight, kOrange);
  for (int i = 0; i < 3; ++i) canvas.rectangle(8 + 18.0 * i, 0, 8, 120, kSun);
  canvas.disc(30, 150, 23, kCream);
  canvas.text("OAT", 30, 142, 15, kRed);
  canvas.rectangle(0, 186, kDepth, 24, kNavy);
  enter(canvas, CartonSide::kLeft);
  canvas.rectangle(0, 0, kDepth, kHeight, kTeal);
  for (int i = 0; i < 5; ++i) {
    const double y = 14 + 22.0 * i;
    canvas.line({{8, y + 16}, {30, y}, {52, y + 16}}, 7, i % 2 == 0 ? kCream : kSun);
  }
  canvas.rectangle(8, 140, 44, 56, kNavy, 4);
  canvas.text("5", 30, 148, 40, kSun);
}

void paint_ends(Canvas& canvas) {
  enter(canvas, CartonSide::kTop);
  canvas.rectangle(0, 0, kWidth, kDepth, kNavy);
  canvas.rectangle(0, 24, kWidth, 12, kSun);
  canvas.disc(30, 30, 20, kRed);
  canvas.text("OPEN", 98, 18.5, 23, kCream);
  enter(canvas, CartonSide::kBottom);
  canvas.rectangle(0, 0, kWidth, kDepth, kCream);
  canvas.rectangle(0, 26, 104, 8, kInk);
  canvas.text("A2", 130, 16, 28, kInk);
}

}  // namespace

Mesh printed_box() {
  Canvas canvas(kSize.sheet_width(), kSize.sheet_height(), 3);
  paint_front(canvas);
  paint_back(canvas);
  paint_sides(canvas);
  paint_ends(canvas);
  return carton(kSize, canvas);
}

}  // namespace sextant
