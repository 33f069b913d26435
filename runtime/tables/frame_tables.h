// SPDX-License-Identifier: Apache-2.0
// What the search looks up, shared by all parts, bins and objects of one frame: squared distance transforms
// of the eight kinds of edges, quantised ray depth, and their minima (and maxima) over square windows. The
// window minima are the constant-time range minimum that the thesis asked for (Davies 2015, p. 119, note 1):
// one look-up bounds a part over a box of poses and becomes exact as the box shrinks.
#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "runtime/base/worker_pool.h"
#include "runtime/frame/search_frame.h"

namespace sextant {

/// Sides of the square windows, pixels. A rectangle takes the smallest that covers its longer side.
inline constexpr std::array<int, 13> kWindowSides{1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96};

/// Level that covers a side of 0..kWindowSides.back() pixels.
inline constexpr auto kLevelOfSide = [] {
  std::array<std::uint8_t, kWindowSides.back() + 1> levels{};
  std::uint8_t level = 0;
  for (std::size_t side = 0; side < levels.size(); ++side) {
    while (kWindowSides[level] < static_cast<int>(side)) ++level;
    levels[side] = level;
  }
  return levels;
}();

/// A plane of 16-bit values with a border of one pixel all round that stands for everything outside.
struct TablePlane {
  std::vector<std::uint16_t> values;
};

/// Tables of one frame. Pixel (x, y) lives at index (y + 1) * stride + (x + 1); positions outside the image
/// are clamped to the border.
class FrameTables {
 public:
  static constexpr std::uint16_t kFar = 65535;           ///< no feature within the clip radius
  static constexpr std::uint16_t kMissing = 65535;       ///< no depth
  static constexpr float kDepthUnit = 0.00005F;          ///< metres per depth step (0.05 mm)
  static constexpr std::uint16_t kLargestDepth = 65000;  ///< 3.25 m; deeper is stored as this

  /// Builds all tables; buffers are reused from call to call. edges: edges_by_direction; clip_radius: pixels
  /// beyond which a feature does not matter, 1..200.
  /// windows false: only the exact planes (level 0), all that LaneTables and `evaluate` need.
  void build(const SearchFrame& frame, const cv::Mat& edges, int clip_radius, WorkerPool& pool,
             bool windows = true);

  int width() const { return width_; }
  int height() const { return height_; }
  int stride() const { return width_ + 2; }
  int clip_radius() const { return clip_radius_; }
  const PinholeCamera& camera() const { return camera_; }

  /// Index of the window level that covers `side` pixels, or kWindowSides.size() where none does.
  static int level_for(int side) {
    return side <= kWindowSides.back() ? kLevelOfSide[static_cast<std::size_t>(side)]
                                       : static_cast<int>(kWindowSides.size());
  }
  int clamp_x(int x) const { return x < -1 ? 0 : (x > width_ ? width_ + 1 : x + 1); }
  int clamp_y(int y) const { return y < -1 ? 0 : (y > height_ ? height_ + 1 : y + 1); }

  /// Squared distance (pixels^2) to the nearest feature of kind k: the minimum over the window of
  /// kWindowSides[level] pixels whose top left is table column cx, row cy (clamped coordinates).
  const std::uint16_t* distance2(int kind, int level) const {
    return distance_[static_cast<std::size_t>(kind)][static_cast<std::size_t>(level)].values.data();
  }
  /// Smallest depth over the window, in steps; kMissing where no pixel has depth.
  const std::uint16_t* nearest_depth(int level) const {
    return nearest_[static_cast<std::size_t>(level)].values.data();
  }
  /// Largest depth over the window, in steps; 0 where no pixel has depth.
  const std::uint16_t* farthest_depth(int level) const {
    return farthest_[static_cast<std::size_t>(level)].values.data();
  }
  /// Non-zero where any pixel of the window misses depth.
  const std::uint16_t* any_missing(int level) const {
    return missing_[static_cast<std::size_t>(level)].values.data();
  }

 private:
  using Levels = std::array<TablePlane, kWindowSides.size()>;
  int width_ = 0;
  int height_ = 0;
  int clip_radius_ = 1;
  PinholeCamera camera_;
  std::array<Levels, 8> distance_;
  Levels nearest_;
  Levels farthest_;
  Levels missing_;
};

}  // namespace sextant
