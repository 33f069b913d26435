// SPDX-License-Identifier: Apache-2.0
#include "runtime/tables/frame_tables.h"

#include <algorithm>
#include <cmath>

#include "runtime/base/error.h"
#include "runtime/tables/distance_transform.h"

namespace sextant {
namespace {

struct Smaller {
  std::uint16_t operator()(std::uint16_t a, std::uint16_t b) const { return std::min(a, b); }
};
struct Larger {
  std::uint16_t operator()(std::uint16_t a, std::uint16_t b) const { return std::max(a, b); }
};

/// Fold of windows of side `big` from those of side `small` (small < big <= 2 small): a big window is the
/// union of four small ones. Windows that reach over the right or bottom edge are clipped there.
template <typename Fold>
void grow_windows(const std::uint16_t* small, std::uint16_t* big, int width, int height, int shift,
                  Fold fold) {
  for (int y = 0; y < height; ++y) {
    const std::uint16_t* a = small + static_cast<std::ptrdiff_t>(y) * width;
    const std::uint16_t* b = small + static_cast<std::ptrdiff_t>(std::min(y + shift, height - 1)) * width;
    std::uint16_t* o = big + static_cast<std::ptrdiff_t>(y) * width;
    const int inner = std::max(0, width - shift);
    for (int x = 0; x < inner; ++x) o[x] = fold(fold(a[x], b[x]), fold(a[x + shift], b[x + shift]));
    for (int x = inner; x < width; ++x) o[x] = fold(fold(a[x], b[x]), fold(a[width - 1], b[width - 1]));
  }
}

template <typename Levels, typename Fold>
void build_levels(Levels& levels, int width, int height, Fold fold) {
  for (std::size_t level = 1; level < kWindowSides.size(); ++level) {
    levels[level].values.resize(levels[0].values.size());
    // The largest finished side that is at least half of this one.
    std::size_t from = level - 1;
    while (from > 0 && 2 * kWindowSides[from - 1] >= kWindowSides[level]) --from;
    grow_windows(levels[from].values.data(), levels[level].values.data(), width, height,
                 kWindowSides[level] - kWindowSides[from], fold);
  }
}

}  // namespace

void FrameTables::build(const SearchFrame& frame, const cv::Mat& edges, int clip_radius, WorkerPool& pool,
                        bool windows) {
  if (clip_radius < 1 || clip_radius > 200) throw std::logic_error("clip_radius outside 1..200");
  width_ = frame.camera.width;
  height_ = frame.camera.height;
  camera_ = frame.camera;
  clip_radius_ = clip_radius;
  const int w = width_ + 2;
  const int h = height_ + 2;
  const std::size_t size = static_cast<std::size_t>(w) * static_cast<std::size_t>(h);
  const auto build_distances = [&](std::size_t kind) {
    Levels& levels = distance_[kind];
    levels[0].values.assign(size, kFar);
    clipped_distance2(edges, static_cast<int>(kind), clip_radius, levels[0].values.data() + w + 1, w);
    if (windows) build_levels(levels, w, h, Smaller{});
  };
  nearest_[0].values.assign(size, kMissing);
  farthest_[0].values.assign(size, 0);
  missing_[0].values.assign(size, 1);
  for (int y = 0; y < height_; ++y) {
    const auto* row = frame.ray_depth_m.ptr<float>(y);
    const std::size_t at = static_cast<std::size_t>(y + 1) * static_cast<std::size_t>(w) + 1;
    for (int x = 0; x < width_; ++x) {
      if (!(row[x] > 0)) continue;
      const float steps = std::min(std::floor(row[x] / kDepthUnit + 0.5F), static_cast<float>(kLargestDepth));
      const auto value = static_cast<std::uint16_t>(std::max(steps, 1.0F));
      nearest_[0].values[at + static_cast<std::size_t>(x)] = value;
      farthest_[0].values[at + static_cast<std::size_t>(x)] = value;
      missing_[0].values[at + static_cast<std::size_t>(x)] = 0;
    }
  }
  pool.for_each(11, [&](std::size_t task) {
    if (task < 8) build_distances(task);
    if (!windows) return;
    if (task == 8) build_levels(nearest_, w, h, Smaller{});
    if (task == 9) build_levels(farthest_, w, h, Larger{});
    if (task == 10) build_levels(missing_, w, h, Larger{});
  });
}

}  // namespace sextant
