// SPDX-License-Identifier: Apache-2.0
#include "runtime/tables/lane_tables.h"

#include <algorithm>
#include <bit>

#include "runtime/tables/window_minimum.h"

namespace sextant {
namespace {

/// A plane in the layout of LanePlanes under construction: all phases, one value per grain.
template <typename T>
struct Plane {
  T* values;
  const LanePlanes* layout;

  T* phase(std::size_t py, std::size_t px) const {
    return values + (py * layout->phases() + px) * layout->phase_size();
  }
};

/// Windows of side `big` grains from windows of side `small` (small <= big <= 2 small): four of them, moved
/// by `big - small`. A move by grains is another phase and perhaps the next cell. What lies over the end of a
/// row of cells is the left border of the next row: as far outside of the image.
template <typename T, typename Fold>
void grow(const Plane<T>& small, const Plane<T>& big, std::size_t move, std::size_t slack, Fold fold) {
  const std::size_t p = small.layout->phases();
  const auto columns = static_cast<std::size_t>(small.layout->columns());
  const std::size_t size = small.layout->phase_size();
  for (std::size_t py = 0; py < p; ++py) {
    const std::size_t my = (py + move) % p;
    const std::size_t rows = (py + move) / p;
    for (std::size_t px = 0; px < p; ++px) {
      const std::size_t mx = (px + move) % p;
      const std::size_t shift = (px + move) / p;
      const T* a = small.phase(py, px);
      const T* b = small.phase(py, mx) + shift;
      const T* c = small.phase(my, px) + rows * columns;
      const T* d = small.phase(my, mx) + rows * columns + shift;
      // The last rows have nothing below them to fold with: they lie outside, where everything is alike.
      const std::size_t count = size - std::min(size, rows * columns + slack);
      T* out = big.phase(py, px);
      fold(a, b, c, d, out, count);
      std::copy(a + count, a + size, out + count);
    }
  }
}

/// All windows of a stage from its grains. level(i): the plane of window i; scratch: two more planes.
template <typename T, typename Level, typename Fold>
void build_windows(const LanePlanes& layout, Level level, std::array<T*, 2> scratch, const T* grains,
                   Fold fold) {
  struct Built {
    int side;
    Plane<T> plane;
  };
  std::vector<Built> built;
  const std::size_t size = layout.plane_size();
  const auto add = [&](int side, T* out) {
    const Plane<T> plane{out, &layout};
    if (side == 1) {
      std::copy(grains, grains + size, out);
    } else {
      // The smallest finished window that is at least half as large.
      const Built* from = &built.back();
      for (const Built& b : built) {
        if (2 * b.side >= side) {
          from = &b;
          break;
        }
      }
      grow(from->plane, plane, static_cast<std::size_t>(side - from->side), kLaneColumns, fold);
    }
    built.push_back({side, plane});
  };
  const auto& windows = layout.stage().windows;
  int side = 1;
  std::size_t spare = 0;
  if (windows[0] > 1) built.push_back({1, {const_cast<T*>(grains), &layout}});
  while (windows[0] > 2 * side) {
    side *= 2;
    add(side, scratch[spare++ % 2]);
  }
  for (std::size_t i = 0; i < kLaneLevels; ++i) add(windows[i], level(i));
}

/// The kernels for one kind of table.
template <typename T>
struct Kernels {
  T outside;
  void (*fold)(const T*, const T*, const T*, const T*, T*, std::size_t);
  void (*halve)(const T*, const T*, T*, std::size_t);
  void (*split)(const T*, std::size_t, std::size_t, T* const*);
};
constexpr Kernels<std::uint8_t> kDistanceKernels{LaneTables::kFarCode, fold_smallest_u8, halve_smallest_u8,
                                                 split_phases_u8};
constexpr Kernels<std::uint16_t> kNearestKernels{FrameTables::kMissing, fold_nearest_u16, halve_nearest_u16,
                                                 split_phases_u16};
constexpr Kernels<std::uint16_t> kFarthestKernels{0, fold_largest_u16, halve_largest_u16, split_phases_u16};

/// An image with even sides: the last row and column may be outside of the frame.
template <typename T>
struct Image {
  std::vector<T> values;
  std::size_t width = 0, height = 0;

  void set_size(std::size_t w, std::size_t h) {
    width = w + w % 2;
    height = h + h % 2;
    values.resize(width * height);
  }
  T* row(std::size_t y) { return values.data() + y * width; }
  const T* row(std::size_t y) const { return values.data() + y * width; }
};

/// Buffers of one thread, reused from frame to frame.
template <typename T>
struct Buffers {
  Image<T> full, half;
  std::vector<T> grains;
  std::array<std::vector<T>, 2> scratch;
};
template <typename T>
Buffers<T>& buffers() {
  thread_local Buffers<T> mine;
  return mine;
}

/// The grains of an image in the layout of a stage, the border around them outside.
template <typename T>
void lay_out(const LanePlanes& layout, const Image<T>& image, const Kernels<T>& kernels, T* out) {
  const std::size_t p = layout.phases();
  const Plane<T> plane{out, &layout};
  std::fill(out, out + layout.plane_size(), kernels.outside);
  const auto columns = static_cast<std::size_t>(layout.columns());
  // The borders are whole numbers of cells: phase 0 starts at the first grain of the image.
  const auto first_column = static_cast<std::size_t>(layout.pad_x() / layout.stage().cell);
  const auto first_row = static_cast<std::size_t>(layout.pad_y() / layout.stage().cell);
  const std::size_t whole = image.width / p;
  for (std::size_t y = 0; y < image.height; ++y) {
    std::array<T*, 4> rows{};
    for (std::size_t px = 0; px < p; ++px) {
      rows[px] = plane.phase(y % p, px) + (first_row + y / p) * columns + first_column;
    }
    kernels.split(image.row(y), p, whole, rows.data());
    for (std::size_t x = whole * p; x < image.width; ++x) rows[x % p][whole] = image.row(y)[x];
  }
}

/// All windows of all stages from the pixels in buffers().full. level(stage, i): the plane of window i.
template <typename T, typename Level>
void build_stages(std::array<LanePlanes, kLaneStages.size()>& stages, const Kernels<T>& kernels,
                  Level level) {
  Buffers<T>& b = buffers<T>();
  b.half.set_size(b.full.width / 2, b.full.height / 2);
  std::fill(b.half.values.begin(), b.half.values.end(), kernels.outside);
  for (std::size_t y = 0; y < b.full.height / 2; ++y) {
    kernels.halve(b.full.row(2 * y), b.full.row(2 * y + 1), b.half.row(y), b.full.width / 2);
  }
  for (LanePlanes& stage : stages) {
    b.grains.resize(stage.plane_size());
    for (auto& s : b.scratch) s.resize(stage.plane_size());
    lay_out(stage, stage.stage().grain == 1 ? b.full : b.half, kernels, b.grains.data());
    build_windows<T>(
        stage, [&](std::size_t i) { return level(stage, i); }, {b.scratch[0].data(), b.scratch[1].data()},
        b.grains.data(), kernels.fold);
  }
}

}  // namespace

void LanePlanes::set_size(const LaneStage& stage, int width, int height) {
  stage_ = &stage;
  width_ = width;
  height_ = height;
  phase_shift_ = std::countr_zero(static_cast<unsigned>(stage.phases()));
  grain_shift_ = std::countr_zero(static_cast<unsigned>(stage.grain));
  columns_ = (width + pad_x()) / stage.cell + kLaneColumns + 1;
  rows_ = (height + pad_y()) / stage.cell + kLaneRows + 1 + stage.windows.back() / stage.phases() + 1;
  // Vectors may be loaded past the end of the last row.
  const std::size_t margin = 64;
  distance_.resize(8 * kLaneLevels * plane_size() + margin);
  nearest_.resize(kLaneLevels * plane_size() + margin);
  farthest_.resize(kLaneLevels * plane_size() + margin);
}

std::size_t LanePlanes::index_of(int ox, int oy) const {
  const int gx = (std::clamp(ox, -pad_x(), width_) + pad_x()) >> grain_shift_;
  const int gy = (std::clamp(oy, -pad_y(), height_) + pad_y()) >> grain_shift_;
  const int mask = (1 << phase_shift_) - 1;
  const int phase = ((gy & mask) << phase_shift_) + (gx & mask);
  return static_cast<std::size_t>((phase * rows_ + (gy >> phase_shift_)) * columns_ + (gx >> phase_shift_));
}

void LaneTables::build(const FrameTables& tables, WorkerPool& pool) {
  const int w = tables.width();
  const int h = tables.height();
  code_scale_ = std::max(1, 254 / tables.clip_radius());
  for (std::size_t s = 0; s < kLaneStages.size(); ++s) stages_[s].set_size(kLaneStages[s], w, h);
  static_assert(kLaneStages[0].grain <= 2 && kLaneStages[1].grain <= 2 && kLaneStages[2].grain <= 2);
  const auto width = static_cast<std::size_t>(w);
  const auto pixel_row = [&](const std::uint16_t* plane, std::size_t y) {
    return plane + (y + 1) * static_cast<std::size_t>(tables.stride()) + 1;
  };
  const auto build_kind = [&](std::size_t kind) {
    Image<std::uint8_t>& full = buffers<std::uint8_t>().full;
    full.set_size(width, static_cast<std::size_t>(h));
    std::fill(full.values.begin(), full.values.end(), kFarCode);
    for (std::size_t y = 0; y < static_cast<std::size_t>(h); ++y) {
      distance_codes(pixel_row(tables.distance2(static_cast<int>(kind), 0), y), code_scale_, full.row(y),
                     width);
    }
    build_stages(stages_, kDistanceKernels, [&](LanePlanes& stage, std::size_t i) {
      return stage.distance_.data() + (kind * kLaneLevels + i) * stage.plane_size();
    });
  };
  const auto build_depth = [&](bool nearest) {
    const Kernels<std::uint16_t>& kernels = nearest ? kNearestKernels : kFarthestKernels;
    Image<std::uint16_t>& full = buffers<std::uint16_t>().full;
    full.set_size(width, static_cast<std::size_t>(h));
    std::fill(full.values.begin(), full.values.end(), kernels.outside);
    for (std::size_t y = 0; y < static_cast<std::size_t>(h); ++y) {
      if (nearest) {
        flag_missing_u16(pixel_row(tables.nearest_depth(0), y), full.row(y), width);
      } else {
        const std::uint16_t* row = pixel_row(tables.farthest_depth(0), y);
        std::copy(row, row + width, full.row(y));
      }
    }
    build_stages(stages_, kernels, [&](LanePlanes& stage, std::size_t i) {
      return (nearest ? stage.nearest_ : stage.farthest_).data() + i * stage.plane_size();
    });
  };
  pool.for_each(10, [&](std::size_t task) {
    if (task < 2) {
      build_depth(task == 0);
    } else {
      build_kind(task - 2);
    }
  });
}

std::size_t LaneTables::bytes() const {
  std::size_t sum = 0;
  for (const LanePlanes& s : stages_) sum += s.bytes();
  return sum;
}

}  // namespace sextant
