// SPDX-License-Identifier: Apache-2.0
// The vector code of the lane bound: first where the windows of 16 parts lie (one part per lane of floats),
// then their costs (one cell per lane of 16-bit integers). Only exact operations: every CPU gets the same
// integers as the plain twin.
#include "runtime/search/lanes/lane_bound.h"

#include "runtime/search/lanes/lane_node_frame.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "runtime/search/lanes/lane_bound.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sextant {
namespace HWY_NAMESPACE {

#if HWY_TARGET == HWY_SCALAR

void LaneBound(const LaneFrame& frame, const LaneBin& bin, const LaneTile& tile, const LaneNode& node,
               std::uint16_t budget, LaneCosts& out) {
  lane_bound_plain(frame, bin, tile, node, budget, out);  // a CPU without vectors of ours
}

#else

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, kPartBlock>;
using Ints = hn::RebindToSigned<Floats>;
using Units = hn::CappedTag<std::uint16_t, 2 * kLaneColumns>;
using FloatVec = hn::Vec<Floats>;
using IntVec = hn::Vec<Ints>;
using UnitVec = hn::Vec<Units>;

constexpr std::size_t kFloatLanes = HWY_LANES(float) < kPartBlock ? HWY_LANES(float) : kPartBlock;
constexpr std::size_t kUnitLanes =
    HWY_LANES(std::uint16_t) < 2 * kLaneColumns ? HWY_LANES(std::uint16_t) : 2 * kLaneColumns;
constexpr std::size_t kVectors = kLanes / kUnitLanes;

/// Where the windows of 16 parts start and what their costs need. offset: from the first value of the tables.
struct Windows {
  alignas(64) std::int32_t offset[kPartBlock];
  alignas(64) std::int32_t inside[kPartBlock];   ///< 0: no window is large enough, the part says nothing
  alignas(64) std::int32_t outside[kPartBlock];  ///< not 0: some lane may fall outside of the image
  alignas(64) std::int32_t reach[kPartBlock];    ///< visual parts: receptive field, codes of distance
  alignas(64) std::int32_t gain[kPartBlock];     ///< visual parts: 65535 / reach
  alignas(64) std::int32_t lowest[kPartBlock];   ///< depth parts: expected depth less z, steps
  alignas(64) std::int32_t highest[kPartBlock];
};

struct Span {
  FloatVec lo, hi;
};

HWY_INLINE Span linear_span(const std::array<std::array<float, kPartBlock>, 4>& c, std::size_t i,
                            const LaneNodeFrame& n) {
  const Floats f;
  const FloatVec c1 = hn::Load(f, c[1].data() + i);
  const FloatVec c2 = hn::Load(f, c[2].data() + i);
  const FloatVec c3 = hn::Load(f, c[3].data() + i);
  FloatVec middle = hn::Add(hn::Load(f, c[0].data() + i), hn::Mul(c1, hn::Set(f, n.middle[0])));
  middle = hn::Add(middle, hn::Mul(c2, hn::Set(f, n.middle[1])));
  middle = hn::Add(middle, hn::Mul(c3, hn::Set(f, n.middle[2])));
  FloatVec half =
      hn::Add(hn::Mul(hn::Abs(c1), hn::Set(f, n.half[0])), hn::Mul(hn::Abs(c2), hn::Set(f, n.half[1])));
  half = hn::Add(half, hn::Mul(hn::Abs(c3), hn::Set(f, n.half[2])));
  return {hn::Sub(middle, half), hn::Add(middle, half)};
}

struct Origin {
  IntVec at, side;
  IntVec outside;  ///< all bits set where some lane may fall outside of the image
};

HWY_INLINE Origin origin_of(Span offset, float lane0, const LaneNodeFrame& n, int cell, int grain, int lanes,
                            int size) {
  const Floats f;
  const Ints d;
  const FloatVec scale_lo = hn::Set(f, n.scale_lo);
  const FloatVec scale_hi = hn::Set(f, n.scale_hi);
  const FloatVec lo = hn::Min(hn::Mul(scale_lo, offset.lo), hn::Mul(scale_hi, offset.lo));
  const FloatVec hi = hn::Max(hn::Mul(scale_lo, offset.hi), hn::Mul(scale_hi, offset.hi));
  const auto to_pixel = [&](FloatVec v, float add) HWY_ATTR {
    const FloatVec moved = hn::Add(v, hn::Set(f, add));
    return hn::ConvertTo(d, hn::Floor(hn::Min(hn::Max(moved, hn::Set(f, -30000.0F)), hn::Set(f, 30000.0F))));
  };
  const IntVec first = to_pixel(lo, lane0 + (0.5F - LaneNodeFrame::kPixelSlack));
  const IntVec last = to_pixel(hi, lane0 + (0.5F + LaneNodeFrame::kPixelSlack));
  const IntVec aligned = hn::And(first, hn::Set(d, ~(grain - 1)));
  const auto beyond = hn::Or(hn::Lt(first, hn::Zero(d)), hn::Gt(last, hn::Set(d, size - lanes * cell)));
  return {first, hn::Sub(hn::Add(last, hn::Set(d, cell)), aligned), hn::VecFromMask(d, beyond)};
}

/// Fills windows.offset and .inside for the parts i, i + 1, ... of one vector. kind_planes: planes before the
/// level's.
HWY_INLINE void place(Span u, Span v, IntVec first_plane, std::size_t i, const LaneTile& tile,
                      const LaneNodeFrame& n, const LanePlanes& planes, Windows& windows) {
  const Ints d;
  const LaneStage& stage = planes.stage();
  const Origin x =
      origin_of(u, static_cast<float>(tile.x0), n, stage.cell, stage.grain, kLaneColumns, planes.width());
  const Origin y =
      origin_of(v, static_cast<float>(tile.y0), n, stage.cell, stage.grain, kLaneRows, planes.height());
  const IntVec side = hn::Max(x.side, y.side);
  IntVec level = hn::Zero(d);
  for (const int window : stage.windows) {
    level = hn::Sub(level, hn::VecFromMask(d, hn::Gt(side, hn::Set(d, window * stage.grain))));
  }
  const auto inside = hn::Lt(level, hn::Set(d, static_cast<std::int32_t>(kLaneLevels)));
  level = hn::IfThenElseZero(inside, level);

  const auto grains = [&](IntVec at, int pad, int size) HWY_ATTR {
    const IntVec clamped = hn::Min(hn::Max(at, hn::Set(d, -pad)), hn::Set(d, size));
    return hn::ShiftRightSame(hn::Add(clamped, hn::Set(d, pad)), planes.grain_shift());
  };
  const IntVec gx = grains(x.at, planes.pad_x(), planes.width());
  const IntVec gy = grains(y.at, planes.pad_y(), planes.height());
  const IntVec mask = hn::Set(d, (1 << planes.phase_shift()) - 1);
  const IntVec phase = hn::Add(hn::ShiftLeftSame(hn::And(gy, mask), planes.phase_shift()), hn::And(gx, mask));
  const IntVec row =
      hn::Add(hn::Mul(phase, hn::Set(d, planes.rows())), hn::ShiftRightSame(gy, planes.phase_shift()));
  const IntVec in_plane =
      hn::Add(hn::Mul(row, hn::Set(d, planes.columns())), hn::ShiftRightSame(gx, planes.phase_shift()));
  const IntVec plane =
      hn::Mul(hn::Add(first_plane, level), hn::Set(d, static_cast<std::int32_t>(planes.plane_size())));
  hn::Store(hn::Add(plane, in_plane), d, windows.offset + i);
  hn::Store(hn::VecFromMask(d, inside), d, windows.inside + i);
  hn::Store(hn::Or(x.outside, y.outside), d, windows.outside + i);
}

HWY_INLINE void place_visual(const VisualBlock& block, const LaneTile& tile, const LaneNodeFrame& n,
                             const LanePlanes& planes, Windows& windows) {
  const Floats f;
  const Ints d;
  for (std::size_t i = 0; i < kPartBlock; i += kFloatLanes) {
    const IntVec kind = hn::Load(d, block.kind.data() + i);
    place(linear_span(block.u, i, n), linear_span(block.v, i, n),
          hn::Mul(kind, hn::Set(d, static_cast<std::int32_t>(kLaneLevels))), i, tile, n, planes, windows);
    const FloatVec codes = hn::Ceil(hn::Mul(hn::Load(f, block.radius.data() + i), hn::Set(f, n.codes)));
    const FloatVec reach = hn::Min(hn::Max(codes, hn::Set(f, 1.0F)), hn::Set(f, 65535.0F));
    hn::Store(hn::ConvertTo(d, reach), d, windows.reach + i);
    hn::Store(hn::ConvertTo(d, hn::Div(hn::Set(f, 65535.0F), reach)), d, windows.gain + i);
  }
}

HWY_INLINE void place_depth(const DepthBlock& block, const LaneTile& tile, const LaneNodeFrame& n,
                            const LanePlanes& planes, Windows& windows) {
  const Floats f;
  const Ints d;
  const auto to_steps = [&](FloatVec v) HWY_ATTR {
    return hn::ConvertTo(d, hn::Min(hn::Max(hn::Floor(v), hn::Set(f, -65000.0F)), hn::Set(f, 65000.0F)));
  };
  for (std::size_t i = 0; i < kPartBlock; i += kFloatLanes) {
    const FloatVec px = hn::Load(f, block.px.data() + i);
    const FloatVec py = hn::Load(f, block.py.data() + i);
    place({px, px}, {py, py}, hn::Zero(d), i, tile, n, planes, windows);
    const Span depth = linear_span(block.d, i, n);
    hn::Store(to_steps(hn::Sub(depth.lo, hn::Set(f, LaneNodeFrame::kDepthSlack))), d, windows.lowest + i);
    hn::Store(to_steps(hn::Add(depth.hi, hn::Set(f, 2.0F + LaneNodeFrame::kDepthSlack))), d,
              windows.highest + i);
  }
}

/// 16 x 4 lanes of a table of 16 bits, vector k of kVectors.
HWY_INLINE UnitVec load_lanes(const std::uint16_t* table, std::size_t columns, std::size_t k) {
  const Units d;
  if constexpr (kUnitLanes == 2 * kLaneColumns) {
    const hn::Half<Units> row;
    return hn::Combine(d, hn::LoadU(row, table + (2 * k + 1) * columns),
                       hn::LoadU(row, table + 2 * k * columns));
  } else {
    constexpr std::size_t per_row = kLaneColumns / kUnitLanes;
    return hn::LoadU(d, table + k / per_row * columns + k % per_row * kUnitLanes);
  }
}

/// The same for a table of bytes.
HWY_INLINE UnitVec load_lanes(const std::uint8_t* table, std::size_t columns, std::size_t k) {
  const Units d;
  const hn::Rebind<std::uint8_t, Units> bytes;
  if constexpr (kUnitLanes == 2 * kLaneColumns) {
    const hn::Half<decltype(bytes)> row;
    return hn::PromoteTo(d, hn::Combine(bytes, hn::LoadU(row, table + (2 * k + 1) * columns),
                                        hn::LoadU(row, table + 2 * k * columns)));
  } else {
    constexpr std::size_t per_row = kLaneColumns / kUnitLanes;
    return hn::PromoteTo(d, hn::LoadU(bytes, table + k / per_row * columns + k % per_row * kUnitLanes));
  }
}

HWY_INLINE void add_visual(const VisualBlock& block, const Windows& windows, const LanePlanes& planes,
                           UnitVec* HWY_RESTRICT units) {
  const Units d;
  const auto columns = static_cast<std::size_t>(planes.columns());
  for (std::size_t i = 0; i < kPartBlock; ++i) {
    if (windows.inside[i] == 0 || block.most[i] == 0) continue;
    const std::uint8_t* table = planes.distance() + windows.offset[i];
    const UnitVec reach = hn::Set(d, static_cast<std::uint16_t>(windows.reach[i]));
    const UnitVec gain = hn::Set(d, static_cast<std::uint16_t>(windows.gain[i]));
    const UnitVec most = hn::Set(d, block.most[i]);
    const UnitVec limit = hn::Set(d, windows.outside[i] != 0 ? block.outside[i] : std::uint16_t{65535});
    for (std::size_t k = 0; k < kVectors; ++k) {
      const UnitVec share = hn::Mul(hn::Min(load_lanes(table, columns, k), reach), gain);
      const UnitVec cost = hn::MulHigh(hn::MulHigh(share, share), most);
      units[k] = hn::SaturatedAdd(units[k], hn::Min(cost, limit));
    }
  }
}

HWY_INLINE void add_depth(const DepthBlock& block, const Windows& windows, const LanePlanes& planes,
                          const LaneNodeFrame& n, UnitVec* HWY_RESTRICT units) {
  const Units d;
  const auto columns = static_cast<std::size_t>(planes.columns());
  const UnitVec one = hn::Set(d, std::uint16_t{1});
  const auto positive = [](int v) { return static_cast<std::uint16_t>(v > 0 ? v : 0); };
  for (std::size_t i = 0; i < kPartBlock; ++i) {
    if (windows.inside[i] == 0 || block.most[i] == 0) continue;
    const std::uint16_t* nearest = planes.nearest() + windows.offset[i];
    const std::uint16_t* farthest = planes.farthest() + windows.offset[i];
    const UnitVec up = hn::Set(d, n.far ? std::uint16_t{65535} : positive(windows.highest[i]));
    const UnitVec down = hn::Set(d, n.far ? std::uint16_t{0} : positive(-windows.highest[i]));
    const UnitVec low_up = hn::Set(d, positive(windows.lowest[i]));
    const UnitVec low_down = hn::Set(d, positive(-windows.lowest[i]));
    const UnitVec reach = hn::Set(d, block.reach[i]);
    const UnitVec near_reach = hn::Set(d, block.near_reach[i]);
    const UnitVec gain = hn::Set(d, block.gain[i]);
    const UnitVec most = hn::Set(d, block.most[i]);
    const UnitVec missing = hn::Set(d, block.missing[i]);
    for (std::size_t k = 0; k < kVectors; ++k) {
      const UnitVec near_value = load_lanes(nearest, columns, k);
      const UnitVec far_value = load_lanes(farthest, columns, k);
      const UnitVec z_hi = hn::Load(d, n.z_hi.data() + k * kUnitLanes);
      const UnitVec z_lo = hn::Load(d, n.z_lo.data() + k * kUnitLanes);
      const UnitVec expected_hi = hn::SaturatedSub(hn::SaturatedAdd(z_hi, up), down);
      const UnitVec expected_lo = hn::SaturatedSub(hn::SaturatedAdd(z_lo, low_up), low_down);
      const UnitVec behind = hn::Min(hn::SaturatedSub(near_value, expected_hi), reach);
      const UnitVec before = hn::Min(hn::SaturatedSub(expected_lo, far_value), near_reach);
      const UnitVec share = hn::Mul(hn::Max(behind, before), gain);
      UnitVec cost = hn::MulHigh(hn::MulHigh(share, share), most);
      const auto any_missing = hn::Eq(hn::And(near_value, one), one);
      cost = hn::IfThenElse(any_missing, hn::Min(cost, missing), cost);
      units[k] = hn::SaturatedAdd(units[k], cost);
    }
  }
}

HWY_INLINE std::uint64_t lanes_within(const UnitVec* units, UnitVec budget) {
  const Units d;
  std::uint64_t mask = 0;
  for (std::size_t k = 0; k < kVectors; ++k) {
    alignas(8) std::uint8_t bits[8] = {};
    const auto within = hn::Eq(hn::SaturatedSub(units[k], budget), hn::Zero(d));
    hn::StoreMaskBits(d, within, bits);
    std::uint64_t part = 0;
    __builtin_memcpy(&part, bits, sizeof(part));
    mask |= part << (k * kUnitLanes);
  }
  return mask;
}

void LaneBound(const LaneFrame& frame, const LaneBin& bin, const LaneTile& tile, const LaneNode& node,
               std::uint16_t budget, LaneCosts& out) {
  const Units d;
  const LaneNodeFrame n(frame, tile, node);
  const LanePlanes& planes = frame.tables.stage(node.stage);
  out.parts = 0;
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    out.units[lane] = (n.alive >> lane) & 1U ? std::uint16_t{0} : std::uint16_t{65535};
  }
  UnitVec units[kVectors];
  for (std::size_t k = 0; k < kVectors; ++k) units[k] = hn::Load(d, out.units.data() + k * kUnitLanes);
  const UnitVec limit = hn::Set(d, budget);
  out.alive = n.alive;
  Windows windows;
  for (std::size_t b = 0; b < bin.order.size() && out.alive != 0; ++b) {
    const std::size_t at = bin.order[b];
    if (at < bin.visual.size()) {
      place_visual(bin.visual[at], tile, n, planes, windows);
      add_visual(bin.visual[at], windows, planes, units);
    } else {
      const DepthBlock& block = bin.depth[at - bin.visual.size()];
      place_depth(block, tile, n, planes, windows);
      add_depth(block, windows, planes, n, units);
    }
    out.parts += kPartBlock;
    out.alive = lanes_within(units, limit);
  }
  for (std::size_t k = 0; k < kVectors; ++k) hn::Store(units[k], d, out.units.data() + k * kUnitLanes);
}

#endif  // HWY_SCALAR

}  // namespace HWY_NAMESPACE
}  // namespace sextant
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sextant {

HWY_EXPORT(LaneBound);

void lane_bound(const LaneFrame& frame, const LaneBin& bin, const LaneTile& tile, const LaneNode& node,
                std::uint16_t budget, LaneCosts& out) {
  HWY_DYNAMIC_DISPATCH(LaneBound)(frame, bin, tile, node, budget, out);
}

}  // namespace sextant
#endif  // HWY_ONCE
