// SPDX-License-Identifier: Apache-2.0
// A small carton of tea: flatter and calmer than the printed box.
#include "offline/mesh/bundled/bundled_meshes.h"
#include "offline/mesh/bundled/carton.h"

namespace sextant {
namespace {

constexpr CartonSize kSize{120, 70, 80};

const Paint kGreen(34, 84, 58);
const Paint kLeaf(120, 168, 72);
const Paint kCream(246, 240, 222);
const Paint kGold(206, 160, 62);
const Paint kInk(38, 40, 38);

void enter(Canvas& canvas, CartonSide side) {
  const CartonPanel p = carton_panel(kSize, side);
  canvas.panel(p.x, p.y, p.width, p.height);
}

void leaf(Canvas& canvas, double x, double y, double size) {
  canvas.polygon(
      {{x, y}, {x + 0.5 * size, y - 0.28 * size}, {x + size, y}, {x + 0.5 * size, y + 0.28 * size}}, kLeaf);
  canvas.line({{x - 0.25 * size, y}, {x + 0.9 * size, y}}, 0.06 * size, kGreen);
}

}  // namespace

Mesh tea_box() {
  Canvas canvas(kSize.sheet_width(), kSize.sheet_height(), 3);
  enter(canvas, CartonSide::kFront);
  canvas.rectangle(0, 0, 120, 80, kGreen);
  canvas.rectangle(8, 10, 104, 44, kCream, 5);
  canvas.text("TEA", 44, 18, 28, kGreen);
  leaf(canvas, 74, 32, 32);
  canvas.rectangle(0, 62, 120, 4, kGold);
  canvas.text("GREEN 20 BAGS", 60, 69, 7, kCream);

  enter(canvas, CartonSide::kBack);
  canvas.rectangle(0, 0, 120, 80, kCream);
  canvas.rectangle(0, 0, 120, 14, kGreen);
  for (int i = 0; i < 5; ++i) canvas.rectangle(8, 22 + 7.0 * i, i % 2 == 0 ? 54 : 46, 3, kInk, 1);
  canvas.disc(92, 40, 18, kGold);
  canvas.disc(92, 40, 13, kCream);
  canvas.text("3", 92, 31, 18, kGreen);
  canvas.bars(10, 62, 40, 14, "21132124123121132141", kInk);

  enter(canvas, CartonSide::kRight);
  canvas.rectangle(0, 0, 70, 80, kLeaf);
  leaf(canvas, 18, 30, 36);
  canvas.rectangle(0, 62, 70, 4, kGold);
  enter(canvas, CartonSide::kLeft);
  canvas.rectangle(0, 0, 70, 80, kGreen);
  for (int i = 0; i < 4; ++i) canvas.line({{6, 14 + 14.0 * i}, {64, 14 + 14.0 * i}}, 4, kGold);

  enter(canvas, CartonSide::kTop);
  canvas.rectangle(0, 0, 120, 70, kCream);
  canvas.rectangle(0, 0, 120, 12, kGreen);
  canvas.text("TEA", 34, 26, 24, kGreen);
  leaf(canvas, 70, 40, 38);
  enter(canvas, CartonSide::kBottom);
  canvas.rectangle(0, 0, 120, 70, kCream);
  canvas.rectangle(20, 30, 80, 6, kInk);
  return carton(kSize, canvas);
}

}  // namespace sextant
