// SPDX-License-Identifier: Apache-2.0
// A carton from its unfolded sheet: the print of each side upright, seen from outside.
#pragma once

#include "offline/mesh/bundled/canvas.h"
#include "offline/mesh/mesh.h"

namespace sextant {

/// Sizes in millimetres: x, y, z. The sheet is 2 (width + depth) wide and height + depth high: front (-y),
/// right, back, left side by side, below them top and bottom.
struct CartonSize {
  double width, depth, height;

  double sheet_width() const { return 2 * (width + depth); }
  double sheet_height() const { return height + depth; }
};

/// A place on the sheet, millimetres from its upper left corner.
struct CartonPanel {
  double x, y, width, height;
};

enum class CartonSide { kFront, kRight, kBack, kLeft, kTop, kBottom };

CartonPanel carton_panel(const CartonSize& size, CartonSide side);

/// Millimetres, z up, base centre in the origin; one part with the sheet as its texture.
Mesh carton(const CartonSize& size, const Canvas& sheet);

}  // namespace sextant
