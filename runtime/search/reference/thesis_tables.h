// SPDX-License-Identifier: Apache-2.0
// The thesis's own tables (Davies 2015, sec. 5.2): summed area tables of the features of each kind, of
// missing depth, and a 3-D one of depth in slabs of 5 cm. Kept as the baseline of tests and benchmarks.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "runtime/tables/frame_tables.h"

namespace sextant {

/// Inclusive rectangle of pixels; may reach outside of the image.
struct PixelRect {
  int x0 = 0, x1 = 0, y0 = 0, y1 = 0;
};

class ThesisTables {
 public:
  static constexpr float kSlab = 0.05F;  ///< metres

  /// Built from the features and depths of the frame tables (distance 0 = feature).
  explicit ThesisTables(const FrameTables& tables);

  /// Number of features of a kind in the rectangle (SUM-2D).
  std::int64_t features(int kind, const PixelRect& r) const;
  /// Number of pixels with missing depth in the part of the rectangle that lies in the image.
  std::int64_t missing(const PixelRect& r) const;
  /// Number of depths in the rectangle and in the slabs that z0..z1 (metres) touch (SUM-3D).
  std::int64_t depths(const PixelRect& r, float z0, float z1) const;
  const FrameTables& frame() const { return tables_; }

 private:
  using Sums = std::vector<std::int32_t>;
  std::int64_t sum(const Sums& sums, std::size_t offset, const PixelRect& r) const;

  const FrameTables& tables_;
  int width_, height_, slabs_;
  std::array<Sums, 8> features_;
  Sums missing_;
  Sums depths_;  ///< per slab prefix: slab-major planes, each the 2-D sums of all slabs up to and with it
};

}  // namespace sextant
