// SPDX-License-Identifier: Apache-2.0
// Window minima for the lane search: what FrameTables::distance2, nearest_depth, farthest_depth and
// any_missing hold for every window, in fewer bits and laid out so that the 16 cells of a row of lanes are 16
// neighbours in memory (a window table for every phase of a cell, as LINEMOD's linearised memories:
// Hinterstoisser et al. 2012, sec. 3.4).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "runtime/base/huge_pages.h"
#include "runtime/base/worker_pool.h"
#include "runtime/tables/frame_tables.h"
#include "runtime/tables/lane_stage.h"

namespace sextant {

/// The tables of one stage. A window has its top left at pixel (ox, oy); `index_of` finds lane 0, the lane
/// `row` rows below and `column` columns to the right is at index + row * columns + column.
class LanePlanes {
 public:
  void set_size(const LaneStage& stage, int width, int height);

  const LaneStage& stage() const { return *stage_; }
  int columns() const { return columns_; }
  int rows() const { return rows_; }
  int phase_shift() const { return phase_shift_; }
  int grain_shift() const { return grain_shift_; }
  /// Origins are clamped to -pad..size before they are looked up: every window there lies outside of the
  /// image.
  int pad_x() const { return kLaneColumns * stage_->cell; }
  int pad_y() const { return kLaneRows * stage_->cell; }
  int width() const { return width_; }
  int height() const { return height_; }
  std::size_t phase_size() const {
    return static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
  }
  /// Values of one plane: all phases of one level (and kind).
  std::size_t plane_size() const { return phase_size() * phases() * phases(); }
  std::size_t phases() const { return static_cast<std::size_t>(stage_->phases()); }

  /// Lane 0 of the window whose origin is pixel (ox, oy), clamped.
  std::size_t index_of(int ox, int oy) const;

  /// Smallest code of distance over the window, all levels of all kinds one after the other.
  const std::uint8_t* distance() const { return distance_.data(); }
  const std::uint8_t* distance(std::size_t kind, std::size_t level) const {
    return distance_.data() + (kind * kLaneLevels + level) * plane_size();
  }
  /// Smallest depth in steps, rounded down to even; bit 0: a pixel of the window has none. 65535: none has.
  const std::uint16_t* nearest() const { return nearest_.data(); }
  const std::uint16_t* nearest(std::size_t level) const { return nearest_.data() + level * plane_size(); }
  /// Largest depth in steps, 0 where no pixel has one.
  const std::uint16_t* farthest() const { return farthest_.data(); }
  const std::uint16_t* farthest(std::size_t level) const { return farthest_.data() + level * plane_size(); }
  std::size_t bytes() const { return distance_.size() + 2 * (nearest_.size() + farthest_.size()); }

 private:
  friend class LaneTables;
  const LaneStage* stage_ = nullptr;
  int width_ = 0, height_ = 0, columns_ = 0, rows_ = 0, phase_shift_ = 0, grain_shift_ = 0;
  HugeVector<std::uint8_t> distance_;
  HugeVector<std::uint16_t> nearest_;
  HugeVector<std::uint16_t> farthest_;
};

/// The tables of all stages of one frame.
class LaneTables {
 public:
  static constexpr std::uint8_t kFarCode = 255;

  /// Builds all stages from the exact planes of `tables`; buffers are reused from call to call.
  void build(const FrameTables& tables, WorkerPool& pool);

  const LanePlanes& stage(std::size_t index) const { return stages_[index]; }
  /// A code c says: no feature is nearer than c / code_scale() pixels. 255: none within the clip radius.
  int code_scale() const { return code_scale_; }
  std::size_t bytes() const;

 private:
  std::array<LanePlanes, kLaneStages.size()> stages_;
  int code_scale_ = 1;
};

}  // namespace sextant
