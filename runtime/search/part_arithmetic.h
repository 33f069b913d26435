// SPDX-License-Identifier: Apache-2.0
// The arithmetic of one part, once for a pose and once for a box. Both run the same operations in the same
// order; float rounding is monotone, so the box version encloses the pose version exactly, without slack.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "runtime/search/lattice.h"
#include "runtime/tables/frame_tables.h"

namespace sextant {

/// Closed interval of floats.
struct FloatRange {
  float lo = 0;
  float hi = 0;
};

/// c0 + c1 rx + c2 ry + c3 rz, from left to right.
inline float linear(float c0, float c1, float c2, float c3, float rx, float ry, float rz) {
  return ((c0 + c1 * rx) + c2 * ry) + c3 * rz;
}
inline float lower_product(float c, FloatRange a) { return std::min(c * a.lo, c * a.hi); }
inline float upper_product(float c, FloatRange a) { return std::max(c * a.lo, c * a.hi); }
inline FloatRange linear(float c0, float c1, float c2, float c3, FloatRange rx, FloatRange ry,
                         FloatRange rz) {
  return {((c0 + lower_product(c1, rx)) + lower_product(c2, ry)) + lower_product(c3, rz),
          ((c0 + upper_product(c1, rx)) + upper_product(c2, ry)) + upper_product(c3, rz)};
}

/// Pixel index of centre + scale * offset: rounded half up, clamped to one pixel outside the image, in the
/// table's coordinates. limit: width or height. The shift by one comes before the conversion, so that
/// truncation rounds down (std::floor is a call on plain x86-64).
inline int table_index(float pixel, int limit) {
  return static_cast<int>(std::min(std::max(pixel + 0.5F, -1.0F), static_cast<float>(limit)) + 1.0F);
}
/// Whether table indices are those of the border that stands for everything outside of the image.
inline bool is_outside(int column, int row, const FrameTables& tables) {
  return column == 0 || row == 0 || column > tables.width() || row > tables.height();
}
struct IndexRange {
  int lo = 0;
  int hi = 0;
};
inline IndexRange table_index(FloatRange centre, FloatRange scale, FloatRange offset, int limit) {
  const float lo = std::min(scale.lo * offset.lo, scale.hi * offset.lo);
  const float hi = std::max(scale.lo * offset.hi, scale.hi * offset.hi);
  return {table_index(centre.lo + lo, limit), table_index(centre.hi + hi, limit)};
}

}  // namespace sextant
